"""Flat pictures show what they should: colours at their place, nothing flipped, every level where it belongs."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from lensbench.errors import InputError
from lensbench.layers import LensMap, Profile
from lensbench.optics.conventions import Status
from lensbench.optics.lens import Lens, Order, Points, circle_outline
from lensbench.optics.materials import MATERIALS
from lensbench.optics.surfaces import sphere
from lensbench.views import bands as banding
from lensbench.views import maps

POINTS = Points((0.0, 4.0), (0.0, 0.0), (0.0, 8.0), (2.5, -13.0))


def a_lens(side="R", **changes):
    surfaces = sphere(90.0), sphere(100.0)
    lens = Lens(
        *surfaces, 2.0, MATERIALS["CR-39"], circle_outline(60.0), side, points=POINTS, ordered=Order(addition=2.0)
    )
    return replace(lens, **changes)


def a_map(function, quantity="astigmatism", unit="D"):
    """A map whose value is function(x, y), on a 1 mm grid within a circle of 60 mm."""
    axis = np.arange(-30.0, 31.0)
    x, y = np.meshgrid(axis, axis)
    inside = np.hypot(x, y) <= 30
    values = np.where(inside, function(x, y) + 0.0 * x, np.nan)
    status = np.where(inside, Status.OK, Status.OUTSIDE_OUTLINE).astype(np.int8)
    return LensMap(quantity, quantity.capitalize(), unit, axis, axis, values, status)


def colour_at(figure, x, y, axes=0):
    """Colour (3,) of the figure's picture at data coordinates of one of its axes."""
    picture = maps.figure_array(figure)
    column, row = figure.axes[axes].transData.transform((x, y))
    return picture[round(picture.shape[0] - row), int(column)].astype(float)


def a_few_points():
    """Five readings on a lens, as somebody takes them by focimeter: no four of them make a cell."""
    x, y = np.array([0.0, 2.5, 20.0]), np.array([-13.0, 3.0, 8.0])
    values = np.full((3, 3), np.nan)
    for j, i, value in ((0, 0, -0.18), (0, 1, 0.06), (1, 0, 0.3), (2, 0, -0.06), (1, 2, 0.18)):
        values[j, i] = value
    return LensMap("mean_error", "Mean power", "D", x, y, values, np.zeros((3, 3), np.int8))


def test_a_few_readings_are_drawn_as_points_with_their_values():
    few = a_few_points()
    figure = maps.map_figure(a_lens(points=Points()), few, 0.12)
    bands = banding.map_bands(a_lens(), few, 0.12)
    for j, i in np.argwhere(np.isfinite(few.values)):
        colour = 255 * bands.colours[int(bands.rank(few.values[j, i]))]
        assert colour_at(figure, few.x[i], few.y[j]) == pytest.approx(colour, abs=2)
        assert f"{few.values[j, i]:+.2f}" in texts(figure)
    assert colour_at(figure, 6, -4) == pytest.approx([255, 255, 255])


def test_maps_and_grids_of_readings_are_not_points():
    assert maps.scattered(a_few_points().values)
    assert not maps.scattered(a_map(lambda x, y: x).values)
    assert not maps.scattered(np.ones((3, 3)))
    assert not maps.scattered(np.full((3, 3), np.nan))


def test_who_looks_stands_in_small_print_below_the_map():
    notes = "Somebody: eye -1.00 D", "The lens was ordered for another"
    plain, noted = (maps.map_figure(a_lens(), a_map(lambda x, y: x / 10), notes=n) for n in ((), notes))
    assert texts(noted).count("Somebody: eye -1.00 D") == 1
    assert noted.get_figheight() == pytest.approx(plain.get_figheight() + 2 * maps.LINE)
    below = [t for t in noted.findobj(Text) if t.get_text() in notes]
    assert max(t.get_position()[1] for t in below) < noted.axes[0].get_position().y0


def texts(figure):
    return " | ".join(t.get_text() for t in figure.findobj(Text))


@pytest.mark.parametrize(("x", "y"), [(1, 0), (0, 1)])
def test_more_astigmatism_is_darker_and_lies_where_it_belongs(x, y):
    figure = maps.map_figure(a_lens(), a_map(lambda u, v: 2 + (x * u + y * v) / 15))
    low, high = (
        colour_at(figure, -20.3 * x + 5.3 * y, -20.3 * y + 5.3 * x),
        colour_at(figure, 20.3 * x + 5, 20.3 * y + 5),
    )
    assert low.sum() > high.sum() + 100
    width, height = figure.canvas.get_width_height()
    right, top = figure.axes[0].transData.transform((20, 20)) > (0.4 * width, 0.6 * height)
    assert right
    assert top


def test_every_band_has_its_colour_in_the_map_and_on_the_bar():
    lens, sloping = a_lens(), a_map(lambda x, y: (x + 30) / 15)
    bands = banding.map_bands(lens, sloping)
    np.testing.assert_allclose(bands.levels, np.arange(0, 4.01, 0.25))
    figure = maps.map_figure(lens, sloping)
    for k in range(2, 14):
        wanted = bands.colours[k] * 255
        np.testing.assert_allclose(colour_at(figure, 15 * (k + 0.5) * 0.25 - 30, -11.3), wanted, atol=2)
        np.testing.assert_allclose(colour_at(figure, 0.5, k + 0.5, axes=1), wanted, atol=2)


def test_isolines_lie_on_their_levels():
    figure = maps.map_figure(a_lens(), a_map(lambda x, y: (x + 30) / 15))
    row = [colour_at(figure, x, -11.3).sum() for x in np.arange(-16.0, -14.0, 0.1)]
    assert abs(np.arange(-16.0, -14.0, 0.1)[int(np.argmin(row))] + 15.0) < 0.25


def test_nothing_is_drawn_outside_the_outline():
    figure = maps.map_figure(a_lens(), a_map(lambda x, y: 4.0 + x / 10))
    for x, y in ((-25.3, 25.3), (25.3, 25.3), (-25.3, -25.3), (25.3, -25.3)):
        assert colour_at(figure, x, y).min() > 220


@pytest.mark.parametrize(("side", "words"), [("R", ("temporal", "nasal")), ("L", ("nasal", "temporal"))])
def test_the_nose_is_on_the_right_of_a_right_lens(side, words):
    figure = maps.map_figure(a_lens(side), a_map(lambda x, y: x / 10))
    label = figure.axes[0].get_xlabel()
    assert label.startswith(words[0])
    assert label.endswith(words[1])
    assert f"{maps.EYE[side]} lens, seen from the front" in texts(figure)


def test_unit_and_reference_points_are_named():
    words = texts(maps.map_figure(a_lens(), a_map(lambda x, y: x / 10, "mean_power"), subtitle="object at 40 cm"))
    for word in (
        "object at 40 cm",
        "D",
        "fitting point",
        "prism reference",
        "distance reference",
        "near reference",
        "+1.00",
    ):
        assert word in words


def test_a_constant_map_is_one_colour_and_says_so():
    figure = maps.map_figure(a_lens(), a_map(lambda x, y: 2.0 + 1e-9 * np.sin(x * y), "thickness", "mm"))
    assert "constant: 2.00 mm" in texts(figure)
    np.testing.assert_array_equal(colour_at(figure, -15, 10), colour_at(figure, 15, -20))


def test_a_map_without_rays_says_so():
    assert "no ray passes" in texts(maps.map_figure(a_lens(), a_map(lambda x, y: np.nan)))


def test_a_plateau_on_a_level_draws_no_noise():
    noise = np.random.default_rng(1).uniform(-2e-5, 2e-5, (61, 61))
    figure = maps.map_figure(a_lens(), a_map(lambda x, y: 0.5 + np.maximum(x, 0) / 20 + noise))
    np.testing.assert_array_equal(colour_at(figure, -20.3, 5.3), colour_at(figure, -10.6, -12.2))
    lines = [line.vertices for c in figure.axes[0].collections for line in c.get_paths() if not c.get_facecolor().size]
    assert len(lines) > 3
    assert all(vertices[:, 0].min() > -2.5 for vertices in lines if len(vertices))


def test_an_axis_map_has_no_isolines_at_its_jump():
    bands = banding.map_bands(a_lens(), a_map(lambda x, y: x % 180, "axis", "deg"))
    assert bands.cyclic
    assert (bands.levels[0], bands.levels[-1]) == (0, 180)
    maps.figure_array(maps.map_figure(a_lens(), a_map(lambda x, y: x % 180, "axis", "deg")))


def test_palest_where_the_power_is_as_ordered():
    lens = a_lens(ordered=Order(-3.0, -1.0, 90.0))
    bands = banding.map_bands(lens, a_map(lambda x, y: -3.5 + x / 20, "mean_power"))
    palest = bands.colours.sum(axis=1).argsort()[-2:]
    assert set(np.round(bands.levels[palest], 2)) == {-3.75, -3.5}


def test_levels_steps_and_their_text():
    lens = a_lens()
    assert np.diff(banding.map_bands(lens, a_map(lambda x, y: x, "mean_power")).levels).max() == pytest.approx(5.0)
    assert banding.map_bands(lens, a_map(lambda x, y: x / 40, "mean_power"), step=0.12).text[0] == "-0.84"
    assert list(banding.map_bands(lens, a_map(lambda x, y: 6 + x / 10, "defocus")).levels) == [3, 5, 7, 10]
    assert banding.map_bands(lens, a_map(lambda x, y: x, "something")).levels.size > 5


def test_a_few_wild_rays_do_not_spoil_the_scale():
    wild = a_map(lambda x, y: np.where((x == 20) & (y == 20), 900.0, 1 + x / 30), "mean_power")
    bands = banding.map_bands(a_lens(), wild)
    assert (bands.levels[0], bands.levels[-1]) == (0.0, 2.0)
    figure = maps.map_figure(a_lens(), wild)
    np.testing.assert_allclose(colour_at(figure, 20, 20), bands.colours[-1] * 255, atol=2)
    spot = a_map(lambda x, y: np.where((x == 20) & (y == 20), 0.9, 0.1))
    assert banding.map_bands(a_lens(), spot).levels[-1] == 1.0


@pytest.mark.parametrize(("step", "limits"), [(0.0, None), (-1.0, None), (1e-5, None), (None, (2.0, 1.0))])
def test_scales_that_make_no_bands_are_refused(step, limits):
    with pytest.raises(InputError):
        banding.map_bands(a_lens(), a_map(lambda x, y: x), step, limits)


def test_shared_limits_hold_all_maps_and_end_on_levels():
    first, second = a_map(lambda x, y: 0.4 + x / 100), a_map(lambda x, y: 1.3 + x / 100)
    assert banding.shared_limits([first, second]) == (0.0, 1.75)
    limits = banding.shared_limits([first, second])
    one, other = (banding.map_bands(a_lens(), m, limits=limits) for m in (first, second))
    np.testing.assert_array_equal(one.levels, other.levels)
    np.testing.assert_array_equal(one.colours, other.colours)
    with pytest.raises(InputError):
        banding.shared_limits([a_map(lambda x, y: np.nan)])


def test_the_margin_continues_the_map_and_holes_stay():
    sloping = a_map(lambda x, y: 1 + 0.1 * x - 0.03 * y)
    status = np.array(sloping.status)
    values = np.array(sloping.values)
    values[30, 20], status[30, 20] = np.nan, Status.TOTAL_INTERNAL_REFLECTION
    filled = banding.extended(replace(sloping, values=values, status=status))
    x, y = np.meshgrid(sloping.x, sloping.y)
    added = np.isfinite(filled) & ~np.isfinite(values)
    assert added.sum() > 100
    np.testing.assert_allclose(filled[added], (1 + 0.1 * x - 0.03 * y)[added], atol=0.06)
    assert np.isnan(filled[30, 20])


def a_profile():
    y = np.linspace(-28, 28, 57)
    mean = 1 - y / 28
    return Profile(0 * y, y, mean, mean - 0.2, mean + 0.2, np.full_like(y, 0.4))


def test_profile_has_height_upwards_and_power_across():
    profile = a_profile()
    figure = maps.profile_figure(a_lens(), profile, "far")
    power, astig = figure.axes
    mean = next(line for line in power.lines if line.get_label() == "mean power")
    np.testing.assert_array_equal(mean.get_xdata(), profile.mean_power)
    np.testing.assert_array_equal(mean.get_ydata(), profile.y)
    assert colour_at(figure, 0.5, 14.0).sum() < 250
    assert colour_at(figure, 0.6, 14.0)[2] < 225
    assert power.get_ylim() == astig.get_ylim() == (-30.0, 30.0)
    verticals = {float(line.get_xdata()[0]) for line in power.lines if len(set(line.get_xdata())) == 1}
    assert verticals >= {0.0, 2.0}
    assert "ordered + addition +2.00 D" in texts(figure)
    maps.figure_array(maps.profile_figure(a_lens(ordered=None), profile))


def test_section_is_to_one_scale_with_the_scene_before_the_lens():
    figure = maps.section_figure(a_lens())
    scales = [np.diff(a.transData.transform([(0, 0), (1, 1)]), axis=0)[0] for a in figure.axes]
    np.testing.assert_allclose(np.abs(scales), abs(scales[0][0]), rtol=1e-6)
    assert scales[0][0] > 0
    assert "2.00 mm" in texts(figure)
    edge = float(a_lens().thickness(30, 0))
    assert f"{edge:.2f} mm" in texts(figure)
    lens_blue = colour_at(figure, 1.0, 0.0)
    assert lens_blue[2] > lens_blue[0] + 20
    np.testing.assert_array_equal(lens_blue, colour_at(figure, 0.0, 1.0, axes=1))
    maps.figure_array(maps.section_figure(a_lens(outline=circle_outline(20.0, (15.0, 3.0)))))


def test_files_are_written_whole(tmp_path):
    figure = maps.section_figure(a_lens())
    maps.save_picture(figure, tmp_path / "a.png")
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "a.png")), maps.figure_array(figure))
    maps.save_picture(figure, tmp_path / "a.svg")
    assert "<text" in (tmp_path / "a.svg").read_text(encoding="utf-8")
    with pytest.raises(InputError):
        maps.save_picture(figure, tmp_path / "a.jpg")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.png", "a.svg"]


def test_figures_do_not_use_the_global_state_of_pyplot():
    figure = maps.map_figure(a_lens(), a_map(lambda x, y: x / 10))
    assert isinstance(figure, Figure)
    assert not hasattr(figure.canvas.manager, "num")
