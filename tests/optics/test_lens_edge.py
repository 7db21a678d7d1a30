"""The cones with flat sides about and within the lens's edge, against the edge itself."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lensbench as lb
from lensbench.optics.lens import box_outline, circle_outline
from lensbench.optics.lens_edge import lens_edge

SAMPLES = Path(__file__).parents[2] / "sample_lenses"
LENS, WEARER = lb.load_lens(SAMPLES / "regular_R.toml"), lb.load_wearer(SAMPLES / "presbyope_60.toml")


@pytest.mark.parametrize("outline", [LENS.outline, circle_outline(30), box_outline(50, 30)])
@pytest.mark.parametrize("sides", [6, 12])
def test_the_edge_lies_between_its_bounds(outline, sides):
    edge = lens_edge(replace(LENS, outline=outline), WEARER)
    about, within = edge.bounds(sides)
    directions = np.random.default_rng(1).normal(size=(200_000, 3))
    inside = edge.within(directions)
    in_about, in_within = ((directions @ normals.T > 0).all(axis=1) for normals in (about, within))
    assert not np.any(inside & ~in_about)
    assert not np.any(in_within & ~inside)
    assert inside.sum() > 0.6 * in_about.sum()
    assert in_within.sum() > 0.4 * inside.sum()
