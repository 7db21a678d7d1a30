"""What the documentation shows, works."""

import re
from pathlib import Path

ROOT = Path(__file__).parent.parent


def test_the_python_example_runs(monkeypatch):
    monkeypatch.chdir(ROOT)
    (example,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "use.md").read_text(encoding="utf-8"), re.DOTALL)
    names: dict = {}
    exec(compile(example, "docs/use.md", "exec"), names)
    assert len(names["sphere"]) == 64 * 64
    assert names["blur"].shape == (1, 2, 2)


def test_every_key_is_documented():
    from lensbench.formats import lens_file, wearer_file
    from lensbench.formats.toml_file import Table

    text = (ROOT / "docs" / "files.md").read_text(encoding="utf-8")
    tables = [
        t for m in (lens_file, wearer_file) for t in vars(m).values() if isinstance(t, type) and issubclass(t, Table)
    ]
    keys = {key for table in tables for key in table.model_fields}
    assert {key for key in keys if not re.search(rf"\b{key}\b", text)} == set()


def test_every_quantity_is_documented():
    from lensbench.quantities import QUANTITIES

    text = (ROOT / "docs" / "use.md").read_text(encoding="utf-8")
    assert {name for name in QUANTITIES if f"`{name}`" not in text} == set()


def test_every_link_leads_somewhere():
    for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), ROOT / "sample_lenses" / "README.md"]:
        for link in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
            assert (page.parent / link).exists(), f"{page.name}: {link}"
