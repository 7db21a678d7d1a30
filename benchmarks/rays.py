"""Rays per second, ours with the transfer matrix, against peers with bare rays, on the same threads."""

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

import lensbench as lb
from lensbench.optics import surfaces
from lensbench.optics.gaze import trace_rays
from lensbench.optics.lens import Lens, circle_outline
from lensbench.optics.materials import MATERIALS

from .figures import Figure
from .timing import rounds

RAYS = 200_000
BACK_RADIUS, THICKNESS, RADIUS, ACROSS = 110.0, 2.0, 95.0, 88.0
NONE = float("nan")
Trace = Callable[[], np.ndarray]


def rays_against_peers() -> list[Figure]:
    """Sphere/sphere, sphere/toric and sphere/B-spline (50 x 50 control points), gazes within 31 degrees."""
    rng = np.random.default_rng(1)
    gaze = np.stack([*rng.uniform(-0.6, 0.6, (2, RAYS)), np.ones(RAYS)], axis=1)
    gaze /= np.linalg.norm(gaze, axis=1, keepdims=True)
    start = np.array([0.0, 0.0, -27.0]) + 10.0 * gaze
    knots, coefficients = progressive()
    fronts = {
        "sphere/sphere": (surfaces.sphere(RADIUS), batoid_sphere, optiland_sphere, 6.0),
        "sphere/toric": (surfaces.toric(1 / RADIUS, 1 / ACROSS, 90.0), None, optiland_torus, None),
        "sphere/B-spline": (surfaces.bspline(knots, knots, coefficients, 3), batoid_bicubic, None, 10.0),
    }
    figures = []
    for name, (front, batoid_front, optiland_front, target) in fronts.items():
        lens = Lens(front, surfaces.sphere(BACK_RADIUS), THICKNESS, MATERIALS["MR-8"], circle_outline(70.0))
        peers = {
            "batoid": batoid_front and batoid_trace(batoid_front(), lens.index, start, gaze),
            "optiland": optiland_front and optiland_trace(optiland_front, lens.index, start, gaze),
        }
        figures += _compared(name, lens, (start, gaze), peers, target)
    return figures


def _compared(
    name: str, lens: Lens, rays: tuple[np.ndarray, np.ndarray], peers: dict[str, Trace | None], target: float | None
) -> list[Figure]:
    columns = (np.asfortranarray(a) for a in rays)  # each peer has its rays in its own order before the clock starts
    ours = partial(trace_rays, lens, lb.Wear(), *columns)
    there = {peer: action for peer, action in peers.items() if action}
    seconds, *theirs = rounds(ours, *there.values(), count=5)
    figures = [Figure(f"{name}: ours, with the transfer matrix", RAYS / seconds / 1e6, "Mrays/s")]
    for peer in peers:
        if peer not in there:
            figures.append(Figure(f"{name}: {peer} has no such surface, or none to compare speed with", NONE, ""))
    for (peer, action), time in zip(there.items(), theirs, strict=True):
        off = float(np.abs(action() - ours().exit.T).max())
        figures += [
            Figure(f"{name}: {peer}, bare rays", RAYS / time / 1e6, "Mrays/s"),
            Figure(f"{name}: ours / {peer}", time / seconds, "x", at_least=target if peer == "batoid" else None),
            Figure(f"{name}: largest difference to {peer}", off, "mm", at_most=1e-9),
        ]
    return figures


def progressive() -> tuple[np.ndarray, np.ndarray]:
    """Knots (both ways) and 50 x 50 coefficients of a cubic surface of 6.3 D that gains 2 D downwards."""
    knots = np.concatenate([[-48.0] * 3, np.linspace(-48, 48, 48), [48.0] * 3])
    at = np.array([knots[k + 1 : k + 4].mean() for k in range(50)])
    x, y = np.meshgrid(at, at)
    sag = np.sqrt(RADIUS**2 - x**2 - y**2) - RADIUS + 5e-5 * (x**2 * y / 2 + y**3 / 6)
    rows = make_interp_spline(at, sag, k=3, t=knots)
    return knots, make_interp_spline(at, rows.c.T, k=3, t=knots).c.T


def batoid_sphere() -> object:
    """The front sphere."""
    import batoid

    return batoid.Sphere(-RADIUS)


def batoid_bicubic() -> object:
    """The same cubic spline as a table of values and derivatives at its knots."""
    import batoid

    knots, coefficients = progressive()
    at = np.unique(knots)

    def derivative(by_x: int, by_y: int) -> np.ndarray:
        rows = BSpline(knots, coefficients, 3)(at, nu=by_y)
        return BSpline(knots, rows.T, 3)(at, nu=by_x).T

    return batoid.Bicubic(at, at, derivative(0, 0), derivative(1, 0), derivative(0, 1), derivative(1, 1))


def batoid_trace(front: object, index: float, start: np.ndarray, gaze: np.ndarray) -> Trace:
    """The lens and rays in batoid, ready to be traced to points (3, n)."""
    import batoid

    back, outer = batoid.Sphere(-BACK_RADIUS), batoid.CoordSys((0, 0, THICKNESS))
    air, glass = batoid.ConstMedium(1.0), batoid.ConstMedium(index)
    rays = batoid.RayVector(*start.T.copy(), *gaze.T.copy())

    def trace() -> np.ndarray:
        moving = rays.copy()
        back.refract(moving, air, glass)
        front.refract(moving, glass, air, coordSys=outer)
        return np.add(moving.r.T, [[0.0], [0.0], [THICKNESS]])

    return trace


def optiland_sphere(where: object) -> object:
    """The front sphere."""
    from optiland.geometries import StandardGeometry

    return StandardGeometry(where, -RADIUS)


def optiland_torus(where: object) -> object:
    """The front torus."""
    from optiland.geometries import ToroidalGeometry

    return ToroidalGeometry(where, -ACROSS, -RADIUS)


def optiland_trace(front: Callable[[object], object], index: float, start: np.ndarray, gaze: np.ndarray) -> Trace:
    """The lens and rays in optiland (numpy backend), ready to be traced to points (3, n)."""
    from optiland.coordinate_system import CoordinateSystem
    from optiland.geometries import StandardGeometry
    from optiland.materials import IdealMaterial
    from optiland.rays import RealRays
    from optiland.surfaces.standard_surface import Surface

    air, glass = IdealMaterial(1.0), IdealMaterial(index)
    before = Surface(None, air, StandardGeometry(CoordinateSystem(z=-100.0), np.inf))
    back = Surface(before, glass, StandardGeometry(CoordinateSystem(), -BACK_RADIUS))
    outer = Surface(back, air, front(CoordinateSystem(z=THICKNESS)))
    ones = np.ones(len(start))

    def trace() -> np.ndarray:
        rays = RealRays(*start.T.copy(), *gaze.T.copy(), ones, 0.55 * ones)
        back.trace(rays, record=False)
        outer.trace(rays, record=False)
        return np.stack([rays.x, rays.y, rays.z])

    return trace
