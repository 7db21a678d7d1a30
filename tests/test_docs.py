"""What the documentation shows, works."""

import dataclasses
import re
import runpy
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parent.parent


def test_the_python_example_runs(monkeypatch):
    monkeypatch.chdir(ROOT)
    (example,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "use.md").read_text(encoding="utf-8"), re.DOTALL)
    names: dict = {}
    exec(compile(example, "docs/use.md", "exec"), names)
    assert len(names["sphere"]) == 64 * 64
    assert names["blur"].shape == (1, 2, 2)


@pytest.mark.usefixtures("gl")
def test_the_pyvista_examples_make_the_pictures_beside_them(monkeypatch, tmp_path):
    shutil.copytree(ROOT / "sample_lenses", tmp_path / "sample_lenses")
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(ROOT / "docs" / "make_pyvista_pictures.py"))["run_examples"](tmp_path)
    shown = re.findall(r"!\[.*?\]\((.*?)\)", (ROOT / "docs" / "pyvista.md").read_text(encoding="utf-8"))
    assert len(shown) == 3
    for name in shown:
        with Image.open(tmp_path / name) as made, Image.open(ROOT / "docs" / name) as kept:
            assert made.size == kept.size
            difference = np.abs(np.asarray(made, dtype=float) - np.asarray(kept, dtype=float))
        assert difference.mean() < 2, name


@pytest.mark.usefixtures("gl")
def test_the_recipe_of_the_view_makes_the_view(monkeypatch):
    from lensbench.views.jitter import render_view

    monkeypatch.chdir(ROOT)
    (example,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "view.md").read_text(encoding="utf-8"), re.DOTALL)
    names: dict = {}
    exec(compile(example, "docs/view.md", "exec"), names)
    seen = names["view"].seen
    meant = render_view(dataclasses.replace(seen, layer=dataclasses.replace(seen.layer, size=(320, 240))), 32)
    np.testing.assert_array_equal(names["picture"][..., :3], meant)


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
