"""How long a designer waits for a map after an edit."""

from dataclasses import replace

import lensbench as lb
from lensbench.optics.conventions import mean_power, power_matrix

from .timing import ROOT, rounds


def map_latency() -> dict[str, float]:
    """A 128 x 128 map of mean power: after a change of refraction, and after a change of the lens; ms."""
    lens = lb.load_lens(ROOT / "sample_lenses" / "regular_R.toml")
    wearer = lb.load_wearer(ROOT / "sample_lenses" / "presbyope_60.toml")
    grid = lb.GazeGrid(128, 128)
    field = lb.trace(lens, wearer, grid)
    eye = replace(wearer.eye, refraction=power_matrix(-1.0))

    def refraction() -> None:
        mean_power(field.with_eye(eye).power_error(400.0))

    def thickness() -> None:
        mean_power(lb.trace(replace(lens, centre_thickness=3.0), wearer, grid).power_error(400.0))

    algebra, traced = rounds(refraction, thickness)
    return {"map after a new refraction, ms": algebra * 1e3, "map after a new thickness, ms": traced * 1e3}
