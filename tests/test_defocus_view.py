"""The defocus map over a view: nothing where nothing is blurred, one scale for all, and a bar that says what is meant."""

import numpy as np
import pytest

from lensbench.errors import InputError
from lensbench.layers import DefocusView, ViewLayer
from lensbench.quantities import QUANTITIES

pytest.importorskip("vtkmodules")

from lensbench.views.defocus import (
    ARCMIN,
    DENSEST,
    SAID,
    Scale,
    defocus_strip,
    scale_bar,
    shared_scale,
    with_defocus,
)

GREY = np.full((30, 40, 3), 100, dtype=np.uint8)


def found(arcmin) -> DefocusView:
    return DefocusView(ViewLayer(), np.broadcast_to(arcmin, (30, 40)) / ARCMIN)


def test_a_veil_whitens_in_proportion():
    ramp = np.linspace(0, 10, 40)
    veiled = with_defocus(GREY, found(ramp), Scale("veil", 10.0))
    assert (veiled[:, 0] == 100).all()
    assert veiled[5, :, 1] == pytest.approx(100 + DENSEST * ramp / 10 * 155, abs=0.51)


def test_beyond_the_lens_and_in_the_void_nothing_is_drawn():
    for way in ("veil", "colours"):
        assert (with_defocus(GREY, found(np.nan), Scale(way, 10.0)) == GREY).all()


def test_colours_are_those_of_the_maps_bands():
    from lensbench.views.bands import value_bands

    bands = value_bands("defocus", np.array([0.0, 30.0]), limits=(0.0, 30.0))
    middles = (bands.levels[1:] + bands.levels[:-1]) / 2
    for middle, colour in zip(middles, bands.colours, strict=True):
        drawn = with_defocus(GREY, found(middle), Scale("colours", 30.0))[0, 0]
        assert drawn == pytest.approx(0.4 * 100 + 0.6 * 255 * colour, abs=0.51)


def test_compared_maps_share_a_scale():
    maps = [found(2.0), found(17.0), found(np.nan)]
    assert shared_scale(maps) == Scale("veil", 20.0)
    with pytest.raises(InputError, match="no point of the scene"):
        shared_scale(maps[2:])
    with pytest.raises(InputError, match="veil, colours"):
        shared_scale(maps, "rainbow")


def test_the_papers_measure_is_named_for_what_it_is():
    papers = DefocusView(ViewLayer(), np.full((30, 40), 17 / ARCMIN), "ellipse_diagonal")
    scale = shared_scale([papers])
    assert scale == Scale("veil", 20.0, "ellipse_diagonal")
    assert (scale_bar(scale, 600, 11) != scale_bar(Scale("veil", 20.0), 600, 11)).any()
    assert "2|ε|" in SAID["ellipse_diagonal"]
    assert "2|ε|" not in SAID["defocus"] + QUANTITIES["defocus"].label


@pytest.mark.parametrize("way", ["veil", "colours"])
def test_the_strip_has_the_bar_of_its_scale_below(way):
    scale = Scale(way, 20.0)
    strip = defocus_strip([("a", GREY, found(3.0)), ("b", GREY, found(18.0))], "caption", scale=scale)
    bar = scale_bar(scale, strip.shape[1], 11)
    assert (strip[-bar.shape[0] :] == bar).all()
    assert (strip == with_defocus(GREY, found(18.0), scale)[0, 0]).all(axis=2).sum() >= 30 * 40
