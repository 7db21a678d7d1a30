"""How long it takes to read the points of a lens."""

import tempfile
from pathlib import Path

import numpy as np
from scipy.interpolate import RectBivariateSpline

import lensbench as lb
from lensbench.formats.body import BodySurface
from lensbench.optics.mirror import mirrored_surface

from .figures import Figure
from .timing import ROOT, rounds

COUNT, WIDTH = 171, 63.75


def reading_points() -> list[Figure]:
    """An SDF pair of 171 x 171 points to two ready-to-trace lenses, ms; and against FITPACK's smoothing of the same points."""
    front = lb.load_surface(ROOT / "sample_lenses" / "regular_R.sdf")
    left = BodySurface("", mirrored_surface(front), "L", "F")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "pair.sdf"
        writing = lb.Writing(WIDTH / (COUNT - 1), (WIDTH, WIDTH))
        lb.write(path, BodySurface("", front, "R", "F"), left, writing=writing)
        points = lb.load(path)

        def pair() -> None:
            lb.load_pair(path)

        def surfaces() -> None:
            for p in points:
                p.fitted(lb.Reading())

        def fitpack() -> None:
            for p in points:
                x, y = p.file_axes()
                RectBivariateSpline(y, x, p.values, kx=5, ky=5, s=p.values.size * 1e-12 / 12)

        whole, ours, theirs = rounds(pair, surfaces, fitpack)
    assert points[0].values.shape == (COUNT, COUNT)
    assert np.isfinite(points[0].values).all()
    return [
        Figure("SDF pair of 171 x 171 to lenses", whole * 1e3, "ms"),
        Figure("  of which surfaces from points", ours * 1e3, "ms"),
        Figure("  FITPACK's smoothing of the same points", theirs * 1e3, "ms"),
    ]
