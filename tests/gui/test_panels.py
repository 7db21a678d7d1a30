"""Forms, the tree and the tables of readings: what they show is the workbench's, what they change is one edit."""

from dataclasses import replace
from math import nan
from pathlib import Path

import pytest

from lensbench.gui.document import Document
from lensbench.gui.fields import EYE, REFRACTION
from lensbench.gui.form import Form
from lensbench.gui.readings_panel import PointsTable, ProbePanel, Reading, TolerancePanel
from lensbench.gui.table_tree import ROLE, TableTree
from lensbench.layers import PointsLayer, ProbeLayer, Request, VerificationLayer
from lensbench.optics.conventions import Status
from lensbench.optics.tolerances import ToleranceLine
from lensbench.session import Workbench
from lensbench.workbench import run

PROGRESSIVE = Path(__file__).parents[2] / "sample_lenses" / "regular_R.toml"


@pytest.fixture
def document(qtbot, sphere):
    return Document(sphere)


@pytest.fixture
def eye_form(qtbot, document):
    form = Form(document, EYE)
    qtbot.addWidget(form)
    return form


def test_typing_is_one_step_each_and_says_its_unit(document, eye_form):
    row = eye_form.rows["Pupil"]
    row.box.setValue(4.3)
    row.box.setValue(5.1)
    assert document.workbench.active_wearer.eye.pupil_diameter == 5.1
    assert row.box.text().endswith("mm")
    document.undo()
    assert document.workbench.active_wearer.eye.pupil_diameter == 4.3
    assert row.box.value() == 4.3
    assert row.slider.value() == round((4.3 - 1.5) / 0.1)


def test_a_drag_is_one_step_and_shows_in_the_box(document, eye_form):
    first, row = document.workbench, eye_form.rows["Pupil"]
    for step in (10, 20, 30):
        row.slider.setValue(step)
    row.slider.sliderReleased.emit()
    assert row.box.value() == pytest.approx(1.5 + 3.0)
    document.undo()
    assert document.workbench is first


def test_what_is_typed_stays_within_bounds(document, eye_form):
    eye_form.rows["Pupil"].box.setValue(99.0)
    assert document.workbench.active_wearer.eye.pupil_diameter == 9.0


def test_age_moves_accommodation_beside_it(eye_form):
    eye_form.rows["Age"].box.setValue(60)
    assert eye_form.rows["Accommodation"].box.value() < 2.0


def test_showing_another_workbench_is_no_edit(document, qtbot):
    form = Form(document, REFRACTION)
    qtbot.addWidget(form)
    document.open(Workbench())
    assert form.rows["Sphere"].box.value() == 0.0
    assert not document.undo_name


def items(tree):
    tops = [tree.topLevelItem(k) for k in range(tree.topLevelItemCount())]
    return [top.child(k) for top in tops for k in range(top.childCount())]


def test_the_tree_makes_what_is_clicked_the_active_one(document, qtbot):
    document.edit("Open", lambda bench: bench.with_lens(PROGRESSIVE))
    tree = TableTree(document)
    qtbot.addWidget(tree)
    first = next(item for item in items(tree) if item.data(0, ROLE) == ("lens", 0))
    tree.itemClicked.emit(first, 0)
    assert document.workbench.lens == 0
    bold = {item.data(0, ROLE) for item in items(tree) if item.font(0).bold()}
    assert bold == {("lens", 0), ("wearer", document.workbench.wearer), ("scene", document.workbench.scene)}
    tree.itemClicked.emit(next(item for item in items(tree) if item.data(0, ROLE) == ("scene", "desk")), 0)
    assert document.workbench.scene == "desk"
    tree.itemClicked.emit(tree.topLevelItem(0), 0)
    document.undo()
    document.undo()
    assert document.workbench.lens == 1


def test_the_tree_shows_text_of_files_as_text(document, qtbot):
    document.edit("Wearer", lambda bench: bench.with_wearer(replace(bench.active_wearer, name="<b>bold</b>")))
    tree = TableTree(document)
    qtbot.addWidget(tree)
    assert any("<b>bold</b>" in item.text(0) for item in items(tree))
    assert any("&lt;b&gt;bold&lt;/b&gt;" in item.toolTip(0) for item in items(tree))


def cells(table, row):
    return [table.item(row, k).text() for k in range(table.columnCount())]


def test_points_are_those_of_run(qtbot):
    bench = Workbench().with_lens(PROGRESSIVE)
    readings = run(Request(bench.active_lens, bench.active_wearer, PointsLayer()))
    table = PointsTable()
    qtbot.addWidget(table)
    table.show_readings(readings)
    assert table.rowCount() == len(readings) == 4
    for k, reading in enumerate(readings):
        name, place, gaze, focimeter, worn, _, less = cells(table, k)
        assert name == reading.name.replace("_", " ")
        assert [float(v) for v in place.split(",")] == pytest.approx([reading.x, reading.y], abs=0.051)
        assert [float(v) for v in gaze.split(",")] == pytest.approx([reading.azimuth, reading.elevation], abs=0.051)
        assert float(focimeter.split(" / ")[0]) == pytest.approx(reading.lensmeter_sphere, abs=0.0051)
        assert float(worn.split(" / ")[0]) == pytest.approx(reading.sphere, abs=0.0051)
        assert float(worn.split(" / ")[1].split(" x ")[0]) == pytest.approx(reading.cylinder, abs=0.0051)
        assert less == ("–" if reading.mean_error is None else f"{reading.mean_error:+.2f}")


def test_a_point_that_no_ray_reaches_says_why(qtbot):
    bench = Workbench().with_lens(PROGRESSIVE)
    reading = run(Request(bench.active_lens, bench.active_wearer, PointsLayer()))[0]
    table = PointsTable()
    qtbot.addWidget(table)
    table.show_readings((replace(reading, status="BUNDLE_CUT"),))
    assert table.item(0, 2).text() == "no ray: bundle cut"


def test_tolerances_are_those_of_run_and_a_miss_is_said(qtbot):
    bench = Workbench().with_lens(PROGRESSIVE)
    found = run(Request(bench.active_lens, bench.active_wearer, VerificationLayer()))
    miss = ToleranceLine("addition", "D", 2.0, 2.3, 0.3, 0.12, False, 0.18)
    unread = ToleranceLine("addition", "D", 2.0, nan, nan, 0.12, False, nan)
    panel = TolerancePanel()
    qtbot.addWidget(panel)
    panel.show_verification(replace(found, lines=(*found.lines, miss, unread)))
    for k, line in enumerate((*found.lines, miss)):
        assert [float(v.split(" ")[0]) for v in cells(panel.table, k)[1:4]] == pytest.approx(
            [line.expected, line.measured, line.deviation], abs=0.051 if line.unit == "deg" else 0.0051
        )
        assert cells(panel.table, k)[5] == ("within" if line.within else f"outside by {line.excess:.2f}")
    assert "outside by 0.18" in cells(panel.table, len(found.lines))
    assert "no reading" in cells(panel.table, len(found.lines) + 1)
    assert panel.said.text().startswith("Judged by ANSI Z80.1-2015 against the order")
    assert "the order is met by a lens that reads" in panel.said.text()
    panel.show_verification(None)
    assert (panel.table.rowCount(), panel.said.text()) == (0, "")


def test_the_probe_says_what_run_says(qtbot, sphere):
    probe = run(Request(sphere.active_lens, sphere.active_wearer, ProbeLayer((6.0, -9.0), None, 400.0)))
    panel = ProbePanel()
    qtbot.addWidget(panel)
    lens, wearer = replace(sphere.active_lens, name="<sphere>"), sphere.active_wearer
    panel.show_reading(Reading(lens, wearer, probe))
    text = panel.text.text()
    for part in (
        f"{probe.azimuth:.1f}°, {probe.elevation:.1f}°", "6.0, -9.0 mm", "40.0 cm", f"{probe.mean_power:+.2f} D",
        f"{2 * probe.semi_major:.2f} × {2 * probe.semi_minor:.2f} mm", f"{probe.accommodation:.2f} D",
        f"{probe.prism:.2f} cm/m", f"{probe.defocus:.1f}′",
    ):  # fmt: skip
        assert part in text
    assert "&lt;sphere&gt;" in text
    assert wearer.name in text
    panel.show_reading(Reading(lens, wearer, probe, "Swim", "%/deg", 1.234))
    assert "Swim</td><td><b>1.23 %/deg" in panel.text.text()
    panel.show_reading(Reading(lens, wearer, replace(probe, status=int(Status.OUTSIDE_OUTLINE))))
    assert "&lt;sphere&gt;" in panel.text.text()
    assert "outside outline" in panel.text.text()
    assert "cm/m" not in panel.text.text()
    panel.show_reading(None)
    assert "Point at" in panel.text.text()
