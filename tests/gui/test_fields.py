"""Fields: what is written is what is read, within bounds, and nothing else changes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lensbench.errors import InputError
from lensbench.gui.fields import EYE, GROUPS, LENS, LOOK, REFRACTION, WEAR, with_material
from lensbench.optics.conventions import power_matrix, sphere_cylinder_axis
from lensbench.optics.eye import hofstetter_amplitude
from lensbench.session import Workbench

FIELDS = {f"{group}: {field.name}": field for group, fields in GROUPS.items() for field in fields}
TIED = {"Age": {"Accommodation"}}


def named(fields, name):
    return next(field for field in fields if field.name == name)


@pytest.fixture(scope="module")
def astigmatic(sphere):
    """The table with a wearer whose refraction has an axis, so that each number of it is read for itself."""
    eye = replace(sphere.active_wearer.eye, refraction=power_matrix(-2.0, -1.5, 30.0))
    return sphere.with_wearer(replace(sphere.active_wearer, eye=eye, age=40.0))


@pytest.mark.parametrize("name", FIELDS)
@given(share=st.floats(0.0, 1.0))
def test_a_field_reads_what_it_writes_and_leaves_the_others(name, astigmatic, share):
    field = FIELDS[name]
    lens_bounds = (2.0, 6.0) if name == "Lens: Centre thickness" else (field.low, field.high)
    value = float(np.interp(share, (0, 1), lens_bounds))
    if name == "Refraction: Cylinder":
        value = min(value, -0.25)
    written = field.write(astigmatic, value)
    read = field.read(written)
    if name == "Refraction: Axis":
        assert (read - value + 90) % 180 - 90 == pytest.approx(0, abs=1e-6)
    else:
        assert read == pytest.approx(value, abs=1e-6, rel=1e-9)
    for other, one in FIELDS.items():
        if other != name and one.name not in TIED.get(field.name, ()):
            assert one.read(written) == pytest.approx(one.read(astigmatic), abs=1e-9), other


@pytest.mark.parametrize("name", FIELDS)
def test_bounds_are_a_whole_number_of_steps_apart_and_steps_are_shown(name):
    field = FIELDS[name]
    steps = (field.high - field.low) / field.step
    assert steps == pytest.approx(round(steps), abs=1e-9)
    assert round(field.step, field.decimals) == pytest.approx(field.step)
    assert field.unit


def test_a_sphere_with_an_axis_keeps_it_when_its_cylinder_is_written_first(sphere):
    for field, value in zip(REFRACTION, (-1.0, -0.75, 35.0), strict=True):
        sphere = field.write(sphere, value)
    np.testing.assert_allclose(
        sphere_cylinder_axis(sphere.active_wearer.eye.refraction), (-1.0, -0.75, 35.0), atol=1e-9
    )


def test_age_brings_its_accommodation_and_the_pose_is_in_radians(sphere):
    old = named(EYE, "Age").write(sphere, 60.0).active_wearer
    assert old.eye.accommodation == hofstetter_amplitude(60.0)
    assert named(WEAR, "Pantoscopic angle").write(sphere, 9.0).active_wearer.wear.pantoscopic_angle == np.radians(9.0)


def test_proximity_is_the_inverse_of_the_distance(sphere):
    field = named(LOOK, "Object proximity")
    assert field.write(sphere, 2.5).distance == 400.0
    assert field.write(sphere, 0.0).distance == np.inf
    assert field.read(replace(sphere, distance="scene")) == 0.0


def test_a_lens_that_would_not_hold_together_is_refused(sphere):
    thickness = named(LENS, "Centre thickness")
    plus = Workbench().with_lens(sphere.lenses[0].path.with_name("sphere_plus_4_R.toml"))
    with pytest.raises(InputError, match="edge would be"):
        thickness.write(plus, 0.5)
    with pytest.raises(InputError, match="cheese"):
        with_material(sphere, "cheese")


def test_without_a_lens_its_fields_do_nothing():
    bare = Workbench()
    for field in (*LENS, *GROUPS["Order"]):
        assert field.write(bare, field.high) is bare
        assert np.isfinite(field.read(bare))
    assert with_material(bare, "MR-8") is bare


@pytest.mark.parametrize(
    ("fields", "name", "follows"),
    [
        (WEAR, "Vertex distance", True), (EYE, "Pupil", True), (REFRACTION, "Sphere", False), (EYE, "Age", False),
        (EYE, "Accommodation", False),
    ],
)  # fmt: skip
def test_who_is_edited_himself_no_longer_follows_the_orders(sphere, fields, name, follows):
    bench = sphere.with_lens(sphere.lenses[0].path.with_name("sphere_plus_4_R.toml"))
    field = named(fields, name)
    written = field.write(bench, 6.0)
    means = [np.trace(written.worn_by(entry.lens).eye.refraction) / 2 for entry in written.lenses]
    assert (means == pytest.approx([-4.0, 4.0])) is follows
    assert (written.active_wearer.name == "as ordered") is follows
    for entry in written.lenses:
        assert field.read(replace(written, lens=written.lenses.index(entry))) == 6.0
