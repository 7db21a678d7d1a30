"""Pictures in space: the lens as worn, the map on it and the ellipses before it stand the right way round."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.text import Text

from lensbench.layers import EllipseSheet, LensMap
from lensbench.optics.conventions import Status
from lensbench.optics.eye import Eye, Wear, Wearer
from lensbench.optics.lens import Lens, Points, circle_outline
from lensbench.optics.materials import MATERIALS
from lensbench.optics.surfaces import sphere

pytest.importorskip("pyvista")
from lensbench.views import bands as banding
from lensbench.views import ellipses, lens3d, maps
from lensbench.views.stage import snapshot, stage

WEARER = Wearer(Eye(), Wear(pantoscopic_angle=np.radians(8.0), face_form_angle=np.radians(5.0)))
SIZE = (400, 320)
ROOM = (SIZE[0] - 100, SIZE[1] - 100)


def a_lens(side="R"):
    points = Points((0.0, 4.0), (0.0, 0.0), (0.0, 8.0), (2.5 if side == "R" else -2.5, -13.0))
    return Lens(sphere(90.0), sphere(120.0), 3.0, MATERIALS["CR-39"], circle_outline(60.0), side, points=points)


def a_map(function, quantity="astigmatism"):
    axis = np.arange(-30.0, 31.0)
    x, y = np.meshgrid(axis, axis)
    inside = np.hypot(x, y) <= 30
    status = np.where(inside, Status.OK, Status.OUTSIDE_OUTLINE).astype(np.int8)
    values = np.where(inside, function(x, y) + 0.0 * x, np.nan)
    return LensMap(quantity, quantity.capitalize(), "D", axis, axis, values, status)


def stage_part(picture):
    """The part (h, w, 3) of a map_on_lens picture that shows the lens."""
    return picture[picture.shape[0] - 30 - ROOM[1] : picture.shape[0] - 30, : ROOM[0]].astype(float)


def test_the_mesh_lies_on_the_surfaces_and_is_closed():
    lens = a_lens()
    mesh = lens3d.lens_mesh(lens, rings=10, around=90)
    front, back = (np.asarray(m.points) for m in (mesh.front, mesh.back))
    np.testing.assert_allclose(front[:, 2], lens.front_height(*mesh.points.T), atol=1e-5)
    np.testing.assert_allclose(back[:, 2], lens.back_height(*mesh.points.T), atol=1e-5)
    assert np.all(mesh.front["Normals"][:, 2] > 0.9)
    skin = (mesh.front + mesh.back + mesh.edge).clean(tolerance=1e-6)
    assert skin.n_open_edges == 0


@pytest.mark.parametrize("side", ["R", "L"])
def test_the_worn_mesh_leans_with_its_lower_and_its_temporal_edge_towards_the_face(side):
    lens = a_lens(side)
    front = np.asarray(lens3d.lens_mesh(lens, WEARER.wear).front.points)
    low, high = front[front[:, 1].argmin()], front[front[:, 1].argmax()]
    assert high[2] - low[2] == pytest.approx(60 * np.sin(np.radians(8)), rel=0.02)
    temporal, nasal = front[front[:, 0].argmin()], front[front[:, 0].argmax()]
    if side == "L":
        temporal, nasal = nasal, temporal
    assert nasal[2] - temporal[2] == pytest.approx(60 * np.sin(np.radians(5)), rel=0.03)


@pytest.mark.usefixtures("gl")
@pytest.mark.parametrize(("x", "y"), [(1, 0), (-1, 0), (0, 1), (0, -1)])
def test_the_map_on_the_lens_is_not_turned_over(x, y):
    picture = stage_part(lens3d.map_on_lens(a_lens(), WEARER, a_map(lambda u, v: 2 + (x * u + y * v) / 15), SIZE))
    lens = picture.min(axis=2) < 235
    rows, columns = np.nonzero(lens)
    dark = 765 - picture.sum(axis=2)[lens]
    middle, darkest = np.array([columns.mean(), -rows.mean()]), np.average([columns, -rows], axis=1, weights=dark)
    shift = darkest - middle
    assert shift @ (x, y) > 5
    assert shift @ (x, y) > abs(shift @ (y, x))


@pytest.mark.usefixtures("gl")
def test_the_bands_on_the_lens_have_the_colours_of_the_bar():
    lens, sloping = a_lens(), a_map(lambda x, y: (x + 30) / 30)
    bands = banding.map_bands(lens, sloping)
    pixels = stage_part(lens3d.map_on_lens(lens, WEARER, sloping, SIZE)).reshape(-1, 3)
    for colour in bands.colours * 255:
        assert np.count_nonzero(np.abs(pixels - colour).max(axis=1) < 18) > 300


@pytest.mark.usefixtures("gl")
def test_a_left_lens_is_the_mirror_image_of_a_right_lens():
    right = stage_part(lens3d.map_on_lens(a_lens("R"), WEARER, a_map(lambda x, y: 2 + x / 15 + y / 40), SIZE))
    left = stage_part(lens3d.map_on_lens(a_lens("L"), WEARER, a_map(lambda x, y: 2 - x / 15 + y / 40), SIZE))
    assert np.abs(right - left[:, ::-1]).mean() < 3
    assert np.abs(right - left).mean() > 10


@pytest.mark.usefixtures("gl")
@pytest.mark.parametrize("function", [lambda x, y: np.nan, lambda x, y: 2.0, lambda x, y: np.where(x > 0, x, np.nan)])
@pytest.mark.parametrize("quantity", ["astigmatism", "axis"])
def test_maps_without_rays_or_without_change_are_drawn(function, quantity):
    assert lens3d.map_on_lens(a_lens(), WEARER, a_map(function, quantity), SIZE).shape == (SIZE[1], SIZE[0], 3)


def a_sheet(x, y, wide, high, depth=500.0):
    """Upright ellipses about points x, y (mm) with half axes wide, high (mm)."""
    x, y, wide, high = np.broadcast_arrays(*(np.atleast_1d(np.asarray(a, dtype=float)) for a in (x, y, wide, high)))
    n = x.size
    spokes = np.zeros((n, 3, 2))
    spokes[:, 0, 0], spokes[:, 1, 1] = wide, high
    centre = np.column_stack([x, y, np.full(n, depth)])
    major, minor = np.maximum(wide, high), np.minimum(wide, high)
    return EllipseSheet(depth, centre, spokes, major, minor, np.zeros(n), np.zeros(n), np.zeros(n, dtype=np.int8))


def coloured(picture):
    """Rows and columns of the panel's coloured pixels (the colour bar is cut off)."""
    panel = picture[:, : int(picture.shape[1] * 0.8)].astype(int)
    return np.nonzero(np.ptp(panel, axis=2) > 40)


def test_ellipses_have_their_size_and_place():
    big = maps.figure_array(ellipses.ellipse_figure(None, WEARER, [a_sheet([0, -80], [0, 60], 30, 10)], 1.0, 4.3))
    rows, columns = coloured(big)
    figure = ellipses.ellipse_figure(None, WEARER, [a_sheet([0, -80], [0, 60], 30, 10)], 1.0, 4.3)
    panel = figure.axes[0]
    corner = panel.transData.transform([(3, -1), (-11, 7)])  # cm: lower left and upper right end of what is drawn
    assert columns.min() == pytest.approx(corner[0, 0], abs=2)
    assert columns.max() == pytest.approx(corner[1, 0], abs=2)
    assert len(big) - rows.max() == pytest.approx(corner[0, 1], abs=2)
    assert len(big) - rows.min() == pytest.approx(corner[1, 1], abs=2)
    assert corner[0, 0] < corner[1, 0]


def test_exaggeration_is_stated_and_applied():
    sheet = a_sheet(0, 0, [4], [2])
    outline = ellipses.ellipse_outlines(sheet, 5.0)
    np.testing.assert_allclose(np.abs(outline).max(axis=(0, 1)), [20, 10, 500])
    words = [t.get_text() for t in ellipses.ellipse_figure(a_lens(), WEARER, [sheet, sheet], 5.0).findobj(Text)]
    assert words.count("50 cm from the eye, ellipses ×5") == 2
    words = [t.get_text() for t in ellipses.ellipse_figure(a_lens(), WEARER, [sheet], 1.0).findobj(Text)]
    assert "50 cm from the eye, true scale" in words


@pytest.mark.parametrize(("half", "factor"), [(4.0, 1.0), (0.9, 5.0), (0.02, 200.0), (40.0, 0.1), (0.0, 1.0)])
def test_automatic_exaggeration_fills_the_grid(half, factor):
    x, y = (a.ravel() for a in np.meshgrid(*[np.arange(-50.0, 51.0, 10.0)] * 2))
    assert ellipses.fitting_exaggeration([a_sheet(x, y, half, half / 2)]) == factor


def test_panels_are_compared_at_one_scale():
    """Sheets of one angular pattern look alike; half the angle is half as large: one field of view, one factor."""
    x, y = (a.ravel() for a in np.meshgrid(*[np.arange(-50.0, 51.0, 10.0)] * 2))
    behind = WEARER.eye.centre_of_rotation
    near, far = a_sheet(x, y, 0.9, 0.9, 300.0), a_sheet(10 * x, 10 * y, 4.5, 4.5, 10 * (300.0 + behind) - behind)
    assert [ellipses.fitting_exaggeration([sheet]) for sheet in (near, far)] == [5.0, 10.0]
    assert ellipses.fitting_exaggeration([near, far]) == 5.0
    figure = ellipses.ellipse_figure(a_lens(), WEARER, [near, far])
    titles = [axes.get_title() for axes in figure.axes[:2]]
    assert [title.split(", ")[1] for title in titles] == ["ellipses ×5", "ellipses ×5"]
    reach = [np.ptp(axes.get_xlim()) for axes in figure.axes[:2]]
    assert reach[1] / reach[0] == pytest.approx(10.0, rel=1e-6)
    nothing = replace(near, status=np.full(near.status.size, Status.MISSED_BACK, dtype=np.int8))
    assert ellipses.fitting_exaggeration([near, nothing]) == 5.0


def test_failed_rays_have_no_ellipse():
    sheet = a_sheet([0, 30, 60], [0, 0, 0], 5, 5)
    centre = np.array(sheet.centre)
    centre[2] = np.nan
    failed = replace(sheet, centre=centre, status=np.array([0, Status.MISSED_FRONT, 0], dtype=np.int8))
    assert len(ellipses.ellipse_outlines(failed)) == 1
    maps.figure_array(ellipses.ellipse_figure(a_lens(), WEARER, [failed]))
    nothing = replace(sheet, status=np.full(3, Status.MISSED_BACK, dtype=np.int8), centre=np.full((3, 3), np.nan))
    maps.figure_array(ellipses.ellipse_figure(a_lens(), WEARER, [nothing]))


@pytest.mark.usefixtures("gl")
def test_the_stack_shows_the_upper_sheet_above_and_survives_sheets_without_rays():
    sheet = a_sheet([-60, 60, -60, 60], [-60, -60, 60, 60], [1, 1, 20, 20], [1, 1, 20, 20])
    picture = ellipses.ellipse_stack(a_lens(), WEARER, [sheet], 1.0, (700, 500))[:, :600].astype(float)
    colour = banding.value_bands("defocus", ellipses.angular_diameters(sheet, WEARER)).colours[-1] * 255
    rows, columns = np.nonzero(np.abs(picture - colour).max(axis=2) < 3)
    assert rows.size > 200
    assert rows.max() < 250
    assert np.ptp(columns) > 100
    nothing = replace(sheet, status=np.full(4, Status.MISSED_BACK, dtype=np.int8), centre=np.full((4, 3), np.nan))
    assert ellipses.ellipse_stack(None, WEARER, [sheet, nothing], size=(700, 500)).shape == (500, 700, 3)


def resident():
    pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
    return pages * 4096 / 1e6


@pytest.mark.usefixtures("gl")
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc here")
def test_pictures_give_their_memory_back():
    lens, sloping = a_lens(), a_map(lambda x, y: x / 10)
    for _ in range(4):
        lens3d.map_on_lens(lens, WEARER, sloping, SIZE)
    before = resident()
    for _ in range(20):
        lens3d.map_on_lens(lens, WEARER, sloping, SIZE)
    assert resident() - before < 30


@pytest.mark.usefixtures("gl")
def test_an_empty_stage_gives_a_picture_of_its_size():
    picture = snapshot(stage((64, 48)))
    assert picture.shape == (48, 64, 3)
    assert picture.dtype == np.uint8
    assert picture.min() == 255


@pytest.mark.parametrize(("side", "on_the_right"), [("R", "nasal"), ("L", "temporal")])
def test_sides_are_named_where_they_are(monkeypatch, side, on_the_right):
    drawn = []
    monkeypatch.setattr(lens3d.maps, "figure_array", lambda figure: drawn.append(figure) or np.zeros((1, 1, 3)))
    lens3d.map_on_lens(a_lens(side), WEARER, a_map(lambda x, y: 2 + x / 15), SIZE)
    at = {t.get_text(): t.get_position()[0] for t in drawn[0].findobj(Text)}
    assert (at["nasal"] > at["temporal"]) == (on_the_right == "nasal")
