"""The flat map of the window: the report's bands, colour for colour and place for place."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.text import Text
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QApplication

from lensbench.gui.map_content import CLOSEST, MapContent, _prepared
from lensbench.gui.map_source import SAMPLES, BandedMap
from lensbench.layers import MapLayer, ProbeLayer, Request
from lensbench.session import Pane
from lensbench.views.bands import map_bands
from lensbench.views.raster import band_pixels, isolines
from lensbench.workbench import run

PANE = Pane("map", "mean_power", low=-3.0, high=1.0, step=0.25)
NEAR = [(11.0, 6.0), (13.0, 8.5), (10.5, 9.0)]
PLACES = [(-18.0, 9.0), (18.0, 9.5), (-18.0, -9.0), (18.0, -9.0), (3.0, 20.0), (0.0, -22.0)]


def slope(x, y):
    """A map that differs left from right and up from down, so that a flipped picture is seen."""
    return -1.1 + 0.041 * x + 0.023 * y


@pytest.fixture(scope="module")
def tilted(sphere):
    found = run(Request(sphere.active_lens, sphere.active_wearer, MapLayer("mean_power", samples=SAMPLES)))
    x, y = np.meshgrid(found.x, found.y)
    return replace(found, values=np.where(np.isfinite(found.values), slope(x, y), np.nan))


def colour_at(bands, value):
    return np.round(255 * bands.colours[np.searchsorted(bands.levels, value, side="right") - 1]).astype(int)


def test_every_pixel_has_the_colour_of_its_band(sphere, tilted):
    bands = map_bands(sphere.active_lens, tilted, PANE.step, (PANE.low, PANE.high))
    pixels = band_pixels(tilted, bands)
    high, wide, _ = pixels.shape
    x = tilted.x[0] + (np.arange(wide) + 0.5) / wide * (tilted.x[-1] - tilted.x[0])
    y = tilted.y[-1] - (np.arange(high) + 0.5) / high * (tilted.y[-1] - tilted.y[0])
    x, y = np.meshgrid(x, y)
    value = slope(x, y)
    inside = sphere.active_lens.outline.contains(x, y) & (np.hypot(x, y) < 29)
    assert np.all(pixels[inside, 3] == 255)
    clear = inside & (np.abs(value / 0.25 - np.round(value / 0.25)) > 0.01)
    assert clear.sum() > 0.5 * inside.sum()
    meant = np.round(255 * bands.colours)[np.searchsorted(bands.levels, value[clear], side="right") - 1]
    np.testing.assert_array_equal(pixels[clear][:, 2::-1], meant)


def test_isolines_lie_on_their_levels(sphere, tilted):
    bands = map_bands(sphere.active_lens, tilted, PANE.step, (PANE.low, PANE.high))
    lines = isolines(tilted, bands)
    assert {line.level for line in lines} >= set(np.flatnonzero((bands.levels > -2) & (bands.levels < -0.2)))
    for line in lines:
        within = np.hypot(*line.points.T) < 29
        np.testing.assert_allclose(slope(*line.points[within].T), bands.levels[line.level], atol=2e-4)


def shown(qtbot, sphere, lens_map, pane=PANE, lens=None):
    content, lens = MapContent(), lens or sphere.active_lens
    qtbot.addWidget(content)
    content.resize(500, 460)
    content.show()
    limits = None if pane.low is None else (pane.low, pane.high)
    banded = BandedMap(lens, sphere.active_wearer, lens_map, map_bands(lens, lens_map, pane.step, limits), limits)
    content.show_answer(_prepared(lambda: banded), sphere, pane)
    qtbot.wait(20)
    return content


def pixel(content, x, y):
    """Median colour of 5 x 5 pixels at a lens point (x, y)."""
    at, image = content.pixel(x, y), content.picture()
    ratio, steps = image.devicePixelRatio(), range(-2, 3)
    middle = round(at.x() * ratio), round(at.y() * ratio)
    return np.median([image.pixelColor(middle[0] + i, middle[1] + j).getRgb()[:3] for i in steps for j in steps], 0)


def test_on_the_screen_every_place_has_its_colour(qtbot, sphere, tilted):
    """All but one, over which a level may be named."""
    content, right = shown(qtbot, sphere, tilted), 0
    for x, y in PLACES:
        value = slope(x, y)
        assert abs(value / 0.25 - round(value / 0.25)) > 0.05, "a place within its band"
        right += np.allclose(pixel(content, x, y), colour_at(content.bands, value), atol=3)
    assert right >= len(PLACES) - 1
    beyond = content.palette().base().color().getRgb()[:3]
    np.testing.assert_array_equal(pixel(content, 27.0, 27.0), beyond)


def test_up_is_up_nasal_is_to_the_left_wearers_right_and_one_scale_holds(qtbot, sphere, tilted):
    content = shown(qtbot, sphere, tilted)
    centre, right, up = (content.pixel(*place) for place in ((0, 0), (10, 0), (0, 10)))
    assert right.x() > centre.x()
    assert up.y() < centre.y()
    assert right.x() - centre.x() == pytest.approx(centre.y() - up.y())
    assert content.data(content.pixel(7.0, -4.0)) == pytest.approx((7.0, -4.0))
    assert content.data(content.pixel(60.0, 0.0)) is None


@pytest.mark.parametrize("quantity", ["axis", "defocus", "thickness"])
def test_quantities_with_scales_of_their_own_are_shown(qtbot, sphere, quantity):
    found = run(Request(sphere.active_lens, sphere.active_wearer, MapLayer(quantity, samples=41)))
    content = shown(qtbot, sphere, found, Pane("map", quantity))
    j, i = found.values.shape[0] // 2 + 3, found.values.shape[1] // 2 + 5
    value, bands = found.values[j, i], content.bands
    assert np.min(np.abs(bands.levels - value)) > 0.02 * np.diff(bands.levels).min(), "a place within its band"
    np.testing.assert_allclose(pixel(content, found.x[i], found.y[j]), colour_at(bands, value), atol=3)


def test_the_pointer_tells_its_lens_point_and_the_probe_is_marked(qtbot, sphere, tilted, mouse):
    content, heard = shown(qtbot, sphere, tilted), []
    content.pointed.connect(lambda point, direction: heard.append((point, direction)))
    for place in ((7.0, -4.0), (29.0, 29.0)):
        at = content.pixel(*place)
        mouse(content, QEvent.Type.MouseMove, at.x(), at.y())
    ((point, direction),) = heard
    assert point == pytest.approx((7.0, -4.0), abs=0.01)
    assert direction is None
    before = content.picture()
    content.show_probe(run(Request(sphere.active_lens, sphere.active_wearer, ProbeLayer(point, None))))
    assert content.marked == pytest.approx(point, abs=1e-6)
    assert content.picture() != before
    content.show_probe(None)
    assert content.picture() == before


def wheel(content, at, notches):
    none, angle = Qt.MouseButton.NoButton, QPoint(0, 120 * notches)
    keys, phase = Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase
    where = QPointF(content.mapToGlobal(at))
    QApplication.sendEvent(content, QWheelEvent(at, where, QPoint(), angle, none, keys, phase, False))


def test_the_wheel_comes_closer_to_what_is_under_the_pointer(qtbot, sphere, tilted):
    content = shown(qtbot, sphere, tilted)
    whole, place = content.box, (12.0, 7.0)
    wheel(content, content.pixel(*place), 3)
    assert content.box[1] - content.box[0] == pytest.approx((whole[1] - whole[0]) / 1.25**3)
    wheel(content, content.pixel(*place), 2)
    assert content.data(content.pixel(*place)) == pytest.approx(place)
    right = [np.allclose(pixel(content, x, y), colour_at(content.bands, slope(x, y)), atol=3) for x, y in NEAR]
    assert sum(right) >= len(NEAR) - 1
    wheel(content, content.pixel(*place), 30)
    assert content.box[1] - content.box[0] == pytest.approx((whole[1] - whole[0]) / CLOSEST)
    wheel(content, content.pixel(*place), -40)
    np.testing.assert_allclose(content.box, whole)


def test_dragging_shifts_what_is_closer_and_a_double_click_shows_all(qtbot, sphere, tilted, mouse):
    content, heard = shown(qtbot, sphere, tilted), []
    whole, left = content.box, Qt.MouseButton.LeftButton
    wheel(content, content.pixel(5.0, 5.0), 4)
    at = content.pixel(5.0, 5.0)
    content.pointed.connect(lambda *read: heard.append(read))
    mouse(content, QEvent.Type.MouseButtonPress, at.x(), at.y(), left)
    mouse(content, QEvent.Type.MouseMove, at.x() - 20, at.y() + 15, left)
    moved = content.pixel(5.0, 5.0)
    assert (moved.x(), moved.y()) == pytest.approx((at.x() - 20, at.y() + 15))
    assert not heard
    for _ in range(200):
        at += QPointF(10, 0)
        mouse(content, QEvent.Type.MouseMove, at.x(), at.y(), left)
    assert content.box[0] == pytest.approx(whole[0])
    mouse(content, QEvent.Type.MouseButtonRelease, at.x(), at.y(), left)
    kept = content.box
    content.show_answer(content.drawn, sphere, PANE)
    assert content.box == kept
    mouse(content, QEvent.Type.MouseButtonDblClick, at.x(), at.y(), left)
    np.testing.assert_allclose(content.box, whole)


def test_the_figure_is_the_reports(qtbot, sphere, tilted):
    words = [text.get_text() for text in shown(qtbot, sphere, tilted).figure().findobj(Text)]
    assert any(tilted.label in word for word in words)
