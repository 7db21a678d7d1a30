"""The built-in scenes stand where they say, are well formed, fine enough and the right way round; letters have their sizes."""

from itertools import pairwise

import numpy as np
import pytest

from lensbench.errors import InputError
from lensbench.scenes import chart
from lensbench.scenes.builtin import SCENES, load_scene
from lensbench.scenes.cast import first_hit
from lensbench.scenes.facts import scene_facts
from lensbench.scenes.scene import Part, Scene

EYES = [(0.0, 0.0, -26.5), (32.0, 0.0, -26.5), (-32.0, 0.0, -26.5)]


@pytest.fixture(scope="module", params=SCENES)
def scene(request) -> Scene:
    return load_scene(request.param)


def part_of(scene: Scene, name: str) -> Part:
    return next(part for part in scene.parts if part.name == name)


def at(part: Part, uv) -> np.ndarray:
    """The place (3,) of a point of the texture, by the triangle that holds it."""
    corner = part.uv[part.triangles]
    side = np.stack([corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]], axis=-1)
    share = np.linalg.solve(side, (np.asarray(uv) - corner[:, 0])[..., None])[..., 0]
    k = np.argmax(np.minimum(share.min(axis=1), 1 - share.sum(axis=1)))
    weight = np.array([1 - share[k].sum(), *share[k]])
    return weight @ part.points[part.triangles[k]]


def test_parts_are_well_formed(scene):
    for part in scene.drawn:
        assert len(part.triangles), part.name
        assert np.isfinite(part.points).all()
        assert part.triangles.min() >= 0
        assert part.triangles.max() < len(part.points)
        assert part.image.dtype == np.uint8
        assert part.image.shape[2] == 3
        assert part.uv.min() >= -1e-9
        assert part.uv.max() <= 1 + 1e-9
        corner = part.points[part.triangles]
        area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
        assert np.count_nonzero(area < 1e-9) < 0.05 * len(area), part.name


def test_no_edge_before_the_eye_is_wider_than_two_degrees(scene):
    facts = scene_facts(scene)
    assert facts["widest_edge"] < 2.001
    assert facts["triangles"] < 90_000


def test_textures_are_not_too_big(scene):
    assert sum(part.image.nbytes for part in scene.drawn) < 80e6
    assert max(max(part.image.shape) for part in scene.drawn) <= 4096


def test_looks_meet_what_they_name_from_either_eye(scene):
    for name, look in scene.looks.items():
        for eye in EYES:
            line = np.array(look.target) - eye
            reach = np.linalg.norm(line)
            distance = first_hit(scene, [eye], [line])[0]
            assert distance == pytest.approx(reach, rel=0.02), (name, eye)
            hit = np.array(eye) + distance * line / reach
            named = [p for p in scene.parts if p.name == look.part]
            assert first_hit(Scene("one", tuple(named)), [eye], [line])[0] == pytest.approx(distance, rel=1e-4), name
            assert np.linalg.norm(hit - look.target) < 0.02 * reach


@pytest.mark.parametrize(
    ("scene_name", "part"), [("room", "page"), ("room", "slide"), ("desk", "screen"), ("cockpit", "instruments")]
)
def test_text_reads_from_left_to_right_and_stands_upright(scene_name, part):
    sheet = part_of(load_scene(scene_name), part)
    left, right, low, high = (at(sheet, uv) for uv in ((0.02, 0.5), (0.98, 0.5), (0.5, 0.02), (0.5, 0.98)))
    assert left[0] > right[0]  # +x is the wearer's left
    assert high[1] > low[1]


# ---- the reading chart ----


@pytest.mark.parametrize(("label", "distance"), [("40 cm", 400), ("60 cm", 600), ("1 m", 1000), ("6 m", 6000)])
def test_letters_have_their_true_size_at_their_distance(label, distance):
    """Measured in the texture: the first row is 50 minutes of arc high, seen from the cornea, and stands at its distance."""
    sheet = part_of(load_scene("chart"), f"chart {label}")
    centre = (sheet.points.min(axis=0) + sheet.points.max(axis=0)) / 2
    assert np.linalg.norm(centre - [0, 0, -13]) == pytest.approx(distance, rel=1e-3)
    height, width = sheet.image.shape[:2]
    dark = (sheet.image < 80).all(axis=2)[:, : int(0.93 * width)]
    rows = np.flatnonzero(dark.any(axis=1))
    first_row = rows[: np.argmax(np.diff(rows) > 1) + 1]
    top, foot = (at(sheet, (0.5, 1 - y / height)) for y in (first_row[0], first_row[-1] + 1))
    seen = 2 * np.arctan(np.linalg.norm(top - foot) / 2 / distance)
    assert np.degrees(seen) * 60 == pytest.approx(50.0, rel=0.02)
    columns = np.flatnonzero(dark[first_row].any(axis=0))
    left, right = (at(sheet, (x / width, 0.9)) for x in (columns[0], columns[-1] + 1))
    assert np.linalg.norm(left - right) == pytest.approx(9 * np.linalg.norm(top - foot), rel=0.02)


def test_rows_shrink_by_a_tenth_of_a_log_unit():
    heights = [chart.letter_height(a, 400.0) for a in (1.0, 0.9, 0.0)]
    assert heights[0] / heights[1] == pytest.approx(10**0.1, rel=1e-4)
    assert np.degrees(heights[2] / 400.0) * 60 == pytest.approx(5.0, rel=1e-4)


def test_every_letter_is_another_and_none_is_mirrored():
    drawn = {}
    for letter in "CDHKNORSVZ":
        s = chart.Sheet(5, 5, 40, (255, 255, 255))
        chart.draw_letter(s, letter, 0, 0, 5)
        drawn[letter] = (s.pixels()[..., 0] < 128).astype(int)
        assert 0.2 < drawn[letter].mean() < 0.75, letter
    for a, b in pairwise(sorted(drawn)):
        assert (drawn[a] != drawn[b]).mean() > 0.05
    half = 100
    assert drawn["C"][:, :half].sum() > 1.15 * drawn["C"][:, half:].sum()  # its gap is on the right
    assert drawn["K"][80:120, :40].all()  # the upright is on the left
    assert drawn["K"][:, 150:].mean() < 0.5
    assert drawn["N"][20, 20]
    assert drawn["N"][100, 100]
    assert not drawn["N"][25, 130]  # its diagonal falls from the left
    assert drawn["Z"][30, 150]
    assert not drawn["Z"][60, 30]  # its diagonal rises to the right
    assert drawn["S"][60, 20]
    assert drawn["S"][140, 180]
    assert not drawn["S"][60, 180]


# ---- names ----


def test_an_unknown_scene_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'room'"):
        load_scene("rooms")
    with pytest.raises(InputError, match="there are room, desk, cockpit, chart, stairs"):
        load_scene("xyz")


def test_a_scene_is_built_once():
    assert load_scene("room") is load_scene("room")


def test_the_sky_is_met_by_no_ray():
    desk = load_scene("cockpit")
    assert desk.sky is not None
    assert np.isinf(first_hit(desk, [[0, 0, 0]], [[0.0, 0.25, 1.0]])[0])
    assert desk.moved(30.0).sky is desk.sky
    assert desk.moved(30.0).looks["far"].target[0] == desk.looks["far"].target[0] + 30.0
