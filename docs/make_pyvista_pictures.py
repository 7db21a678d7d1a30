"""The pictures of docs/pyvista.md, by its own examples: python docs/make_pyvista_pictures.py. Look at them afterwards."""

import os
import re
from pathlib import Path

from lensbench.views.offscreen import require_gl

DOCS = Path(__file__).parent


def run_examples(folder: Path) -> None:
    """Run every example of the page as a script of its own; the pictures go to `folder`, which holds sample_lenses."""
    require_gl()
    os.chdir(folder)
    for example in re.findall(r"```python\n(.*?)```", (DOCS / "pyvista.md").read_text(encoding="utf-8"), re.DOTALL):
        exec(compile(example, "docs/pyvista.md", "exec"), {})


if __name__ == "__main__":
    import shutil
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(DOCS.parent / "sample_lenses", Path(folder) / "sample_lenses")
        run_examples(Path(folder))
        for picture in Path(folder).glob("*.png"):
            shutil.copy(picture, DOCS)
