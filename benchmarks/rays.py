"""Rays per second, ours with the transfer matrix, against peers with bare rays."""

from collections.abc import Callable
from functools import partial

import numpy as np

import lensbench as lb
from lensbench.optics import surfaces
from lensbench.optics.gaze import trace_rays
from lensbench.optics.lens import Lens, circle_outline
from lensbench.optics.materials import MATERIALS

from .timing import rounds


def rays_against_batoid() -> dict[str, float]:
    """Sphere/sphere and sphere/asphere, gazes within 31 degrees: ours with the transfer matrix, batoid's bare rays."""
    n = 200_000
    rng = np.random.default_rng(1)
    gaze = np.stack([*rng.uniform(-0.6, 0.6, (2, n)), np.ones(n)], axis=1)
    gaze /= np.linalg.norm(gaze, axis=1, keepdims=True)
    start = np.array([0.0, 0.0, -27.0]) + 10.0 * gaze
    found = {}
    for name, alpha in (("sphere/sphere", 0.0), ("sphere/asphere", 2e-7)):
        front = surfaces.conic(1 / 95.0, 0.0, [alpha])
        lens = Lens(front, surfaces.sphere(110.0), 2.0, MATERIALS["MR-8"], circle_outline(70.0))
        ours, theirs = rounds(partial(trace_rays, lens, lb.Wear(), start, gaze), batoid_trace(lens, alpha, start, gaze))
        found[f"{name}: ours with transfer matrix, Mrays/s"] = n / ours / 1e6
        found[f"{name}: batoid, Mrays/s"] = n / theirs / 1e6
        found[f"{name}: ratio"] = theirs / ours
    return found


def batoid_trace(lens: Lens, alpha: float, start: np.ndarray, gaze: np.ndarray) -> Callable[[], None]:
    """The same lens and rays in batoid, ready to be traced."""
    import batoid

    front = batoid.Asphere(-95.0, 0.0, [-alpha]) if alpha else batoid.Sphere(-95.0)
    back, outer = batoid.Sphere(-110.0), batoid.CoordSys((0, 0, lens.centre_thickness))
    air, glass = batoid.ConstMedium(1.0), batoid.ConstMedium(lens.index)
    rays = batoid.RayVector(*start.T, *gaze.T)

    def trace() -> None:
        moving = rays.copy()
        back.refract(moving, air, glass)
        front.refract(moving, glass, air, coordSys=outer)

    return trace
