"""The built-in scene stands where it says, is fine enough for the pictures, and rays meet it where geometry says."""

import numpy as np
import pytest

from lensbench.errors import InputError
from lensbench.optics.conventions import unit
from lensbench.scenes.builtin import load_scene
from lensbench.scenes.cast import first_hit
from lensbench.scenes.scene import Part, Scene, rectangle

GREY = np.full((2, 2, 3), 128, dtype=np.uint8)


@pytest.fixture(scope="module")
def room() -> Scene:
    return load_scene("room")


def part_of(scene: Scene, name: str) -> Part:
    return next(part for part in scene.parts if part.name == name)


@pytest.mark.parametrize(("name", "distance", "elevation"), [("page", 392, (-30, -25)), ("screen", 760, (-12, -8))])
def test_near_objects_stand_where_the_wearer_looks_down(room, name, distance, elevation):
    points = part_of(room, name).points
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    up = points[np.argmax(points[:, 1])] - points[np.argmin(points[:, 1])]
    assert centre[0] == pytest.approx(0, abs=1e-9)
    assert np.linalg.norm(centre) == pytest.approx(distance, abs=1e-6)
    assert elevation[0] < np.degrees(np.arcsin(unit(centre)[1])) < elevation[1]
    assert abs(unit(up * [0, 1, 1]) @ unit(centre)) < 1e-9  # it faces the eye


def test_far_things_fill_the_view_straight_ahead(room):
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(-0.466, 0.466, 61), np.linspace(-0.35, 0.35, 47)))
    distance = first_hit(room, np.zeros(3), unit(np.stack([u, v, np.ones_like(u)], axis=-1)))
    assert np.isfinite(distance).all()
    assert np.mean(distance > 3000) > 0.6
    assert first_hit(room, np.zeros((1, 3)), [[0.0, 0.0, 1.0]])[0] == pytest.approx(5960, rel=1e-5)


def test_no_triangle_is_wider_than_two_degrees(room):
    assert sum(len(part.triangles) for part in room.parts) < 60_000
    for part in room.parts:
        corner = unit(part.points)[part.triangles]
        sides = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)
        assert np.degrees(sides.max()) < 2.001, part.name


def test_textures_are_fine_enough_and_not_too_big(room):
    assert sum(part.image.nbytes for part in room.parts) < 60e6
    pixel = 2 * np.tan(np.radians(25)) / 1280
    for name in ("page", "screen", "slide"):
        part = part_of(room, name)
        width = np.ptp(part.points[:, 0]) / np.linalg.norm(part.points, axis=1).min()
        assert part.image.shape[1] > 1.9 * width / pixel, name
    for part in room.parts:
        assert part.uv.min() >= 0
        assert part.uv.max() <= 1
        assert part.image.dtype == np.uint8


def test_text_reads_from_left_to_right():
    part = rectangle("sheet", [0, 0, 500], [-50, 0, 0], [0, 30, 0], GREY)
    left = part.points[part.uv[:, 0] == 0]
    assert np.allclose(left[:, 0], 50)  # the wearer's left
    assert np.allclose(part.points[part.uv[:, 1] == 1][:, 1], 30)


def test_an_unknown_scene_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'room'"):
        load_scene("rooms")
    with pytest.raises(InputError, match="there are room"):
        load_scene("xyz")


def test_first_hit_meets_a_tilted_plane_where_the_closed_form_does():
    normal = unit(np.array([0.2, -0.3, -1.0]))
    across = unit(np.cross(normal, [0.0, 1.0, 0.0]))
    centre = np.array([10.0, -20.0, 600.0])
    scene = Scene("plane", (rectangle("plane", centre, 900 * across, 900 * np.cross(normal, across), GREY),))
    chance = np.random.default_rng(3)
    origin = chance.uniform(-5, 5, (500, 3))
    direction = unit(chance.uniform([-0.5, -0.5, 1], [0.5, 0.5, 1], (500, 3)))
    exact = (centre - origin) @ normal / (direction @ normal)
    assert np.allclose(first_hit(scene, origin, 3 * direction), exact, rtol=2e-6)


def test_first_hit_says_what_it_does_not_meet():
    scene = Scene("wall", (rectangle("wall", [0, 0, 500], [-100, 0, 0], [0, 100, 0], GREY),))
    ahead, back, lost, aside = [0, 0, 1.0], [0, 0, -1.0], [np.nan, 0, 1.0], [1.0, 0, 0.1]
    found = first_hit(scene, np.zeros((4, 3)), [ahead, back, lost, aside])
    assert found[0] == pytest.approx(500)
    assert np.isinf(found[[1, 3]]).all()
    assert np.isnan(found[2])


def test_first_hit_takes_the_nearer_of_two():
    near, far = (rectangle(str(z), [0, 0, z], [-100, 0, 0], [0, 100, 0], GREY) for z in (300, 900))
    assert first_hit(Scene("two", (far, near)), [[0, 0, 0]], [[0, 0, 1]])[0] == pytest.approx(300)
