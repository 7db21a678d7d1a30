"""The lens: two surfaces, thickness, material, outline, reference points and the order it was made for."""

from dataclasses import dataclass, field, fields
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .conventions import Floats, ReadOnlyArrays, power_matrix
from .kernels import outline as kernel
from .materials import Material
from .surfaces import Surface


@dataclass(frozen=True, slots=True, eq=False)
class Outline(ReadOnlyArrays):
    """Edge of the lens in the lens frame, seen along z: a star-shaped curve about its centre.

    centre: (x, y) mm. angles (k,): rising, rad in [0, 2 pi). radii (k,): mm, linear between the angles.
    """

    centre: tuple[float, float]
    angles: Floats
    radii: Floats

    def radius(self, angle: ArrayLike) -> Floats:
        """Distance (mm) from the centre to the edge at angles in rad."""
        return np.interp(np.asarray(angle, dtype=float), self.angles, self.radii, period=2 * np.pi)

    def contains(self, x: ArrayLike, y: ArrayLike) -> np.ndarray:
        """Whether points x, y (mm, lens frame) lie within the edge; False for NaN."""
        bx, by = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        out = np.empty(bx.size, dtype=bool)
        px, py = (np.ascontiguousarray(a).ravel() for a in (bx, by))
        kernel.contains(self.shape_arrays(), px, py, out)
        return out.reshape(bx.shape)

    def shape_arrays(self) -> tuple[Floats, Floats, Floats]:
        """(limits, angles, radii) as the kernels take them."""
        limits = np.array([*self.centre, self.radii.min() ** 2, self.radii.max() ** 2])
        return limits, np.ascontiguousarray(self.angles), np.ascontiguousarray(self.radii)

    def points(self, count: int | None = None) -> tuple[Floats, Floats]:
        """x, y of points along the edge, mm, counter-clockwise from +x: `count` of equal angles, or all that define it."""
        angle = self.angles if count is None else np.linspace(0, 2 * np.pi, count, endpoint=False)
        r = self.radius(angle)
        return self.centre[0] + r * np.cos(angle), self.centre[1] + r * np.sin(angle)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """(x min, x max, y min, y max), mm."""
        x, y = self.points()
        return float(x.min()), float(x.max()), float(y.min()), float(y.max())


_ANGLES = np.linspace(0, 2 * np.pi, 1440, endpoint=False)


def ellipse_outline(width: float, height: float, centre: tuple[float, float] = (0.0, 0.0)) -> Outline:
    """Ellipse of full width and height, mm."""
    r = 0.5 / np.hypot(np.cos(_ANGLES) / width, np.sin(_ANGLES) / height)
    return Outline(centre, _ANGLES, r)


def circle_outline(diameter: float, centre: tuple[float, float] = (0.0, 0.0)) -> Outline:
    """Circle, diameter in mm."""
    return ellipse_outline(diameter, diameter, centre)


def box_outline(width: float, height: float, centre: tuple[float, float] = (0.0, 0.0)) -> Outline:
    """Rectangle of full width and height, mm."""
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [width / 2, height / 2]
    return polygon_outline(corners + centre, centre)


def polygon_outline(points: ArrayLike, centre: tuple[float, float] | None = None) -> Outline:
    """Closed polygon (k, 2) in mm, given counter-clockwise or clockwise; star-shaped about its centre (mean by default).

    Points that repeat the one before them count once. Raises ValueError when the polygon is not star-shaped about the
    centre.
    """
    p = np.asarray(points, dtype=float)
    p = p[np.any(p != np.roll(p, 1, axis=0), axis=1)]
    c = (float(p[:, 0].mean()), float(p[:, 1].mean())) if centre is None else centre
    start = p - c
    if np.sum(start[:, 0] * np.roll(start[:, 1], -1) - start[:, 1] * np.roll(start[:, 0], -1)) < 0:
        start = start[::-1]
    side = np.roll(start, -1, axis=0) - start
    reach = start[:, 0] * side[:, 1] - start[:, 1] * side[:, 0]
    corner = np.unwrap(np.arctan2(start[:, 1], start[:, 0]))
    turn = np.append(corner, corner[0] + 2 * np.pi)
    if np.any(np.diff(turn) <= 0) or np.any(reach <= 0):
        raise ValueError("the outline is not star-shaped about its centre: each ray from the centre must cut it once")
    angle = np.sort(np.concatenate([_ANGLES, corner % (2 * np.pi)]))
    segment = np.searchsorted(turn, (angle - corner[0]) % (2 * np.pi) + corner[0], side="right") - 1
    segment = np.clip(segment, 0, len(start) - 1)
    radius = reach[segment] / (np.cos(angle) * side[segment, 1] - np.sin(angle) * side[segment, 0])
    return Outline(c, angle, radius)


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Reference points on the front surface (x, y) in mm, lens frame; ISO 13666 terms. near inset: mm towards the nose."""

    fitting_point: tuple[float, float] = (0.0, 0.0)
    prism_reference_point: tuple[float, float] = (0.0, 0.0)
    distance_reference_point: tuple[float, float] | None = None
    near_reference_point: tuple[float, float] | None = None
    near_inset: float | None = None

    def named(self) -> dict[str, tuple[float, float]]:
        """The points that the lens has, by name."""
        values = {f.name: getattr(self, f.name) for f in fields(self) if f.name.endswith("_point")}
        return {name: value for name, value in values.items() if value is not None}


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """A power as ordered or as it is to be verified: sphere, cylinder, addition (D), axis (degrees), prism (cm/m) and prism
    base (degrees, 0 to 360).
    """

    sphere: float = 0.0
    cylinder: float = 0.0
    axis: float = 180.0
    addition: float = 0.0
    prism: float = 0.0
    prism_base: float = 0.0

    def power(self, near: bool = False) -> Floats:
        """Ordered power matrix (2, 2), D, for the distance or (with the addition) for the near reference point."""
        return power_matrix(self.sphere + (self.addition if near else 0.0), self.cylinder, self.axis)

    def prism_components(self) -> Floats:
        """Ordered prism (2,), cm/m, along x and y, positive towards the base."""
        base = np.radians(self.prism_base)
        return self.prism * np.array([np.cos(base), np.sin(base)])


class EdgeThickness(NamedTuple):
    """Thinnest place of the edge: thickness, x, y in mm, lens frame."""

    thickness: float
    x: float
    y: float


@dataclass(frozen=True, slots=True, eq=False)
class Lens:
    """A spectacle lens. side: "R" or "L". wavelength: reference line, "d" or "e". centre_thickness: mm at the vertices.

    verification_power: what a focimeter must read where that is not the order, as of lenses compensated for the position
    of wear. note: what was assumed where its file leaves something open, one line.
    """

    front: Surface
    back: Surface
    centre_thickness: float
    material: Material
    outline: Outline
    side: str = "R"
    wavelength: str = "e"
    points: Points = field(default_factory=Points)
    ordered: Order | None = None
    name: str = ""
    note: str = ""
    verification_power: Order | None = None

    @property
    def expected_by_focimeter(self) -> Order | None:
        """What a focimeter should read: the verification power, else the order."""
        return self.verification_power or self.ordered

    @property
    def power_point(self) -> tuple[float, float]:
        """Lens point (mm) of the ordered power: the distance reference point, else the prism reference point."""
        return self.points.distance_reference_point or self.points.prism_reference_point

    @property
    def index(self) -> float:
        """Refractive index at the lens's reference wavelength."""
        return self.material.index(self.wavelength)

    def front_height(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """z (mm) of the front surface above lens points x, y (mm, any shape); NaN where there is none."""
        return self.centre_thickness + surface_height(self.front, x, y)

    def back_height(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """z (mm) of the back surface above lens points x, y (mm, any shape); NaN where there is none."""
        return surface_height(self.back, x, y)

    def thickness(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Thickness (mm) along z at lens points x, y (mm, any shape)."""
        return self.front_height(x, y) - self.back_height(x, y)

    def minimum_edge_thickness(self) -> EdgeThickness:
        """Where the edge is thinnest, over the points that define the outline."""
        x, y = self.outline.points()
        t = self.thickness(x, y)
        k = int(np.argmin(np.where(np.isnan(t), np.inf, t)))
        return EdgeThickness(float(t[k]), float(x[k]), float(y[k]))

    def disc_points(self, radial: int = 24, around: int = 720) -> tuple[Floats, Floats, Floats]:
        """x, y (mm, lens frame) and area weights (mm2) of a quadrature over the lens: Gauss-Legendre by midpoints."""
        node, weight = np.polynomial.legendre.leggauss(radial)
        angle = (np.arange(around) + 0.5) * 2 * np.pi / around
        edge = self.outline.radius(angle)[:, None]
        r = edge * (node + 1) / 2
        area = r * edge * weight / 2 * (2 * np.pi / around)
        x = self.outline.centre[0] + r * np.cos(angle)[:, None]
        y = self.outline.centre[1] + r * np.sin(angle)[:, None]
        return x, y, area

    def meridian_x(self, y: ArrayLike) -> Floats:
        """x (mm) of the main meridian at heights y (mm): through fitting and near reference point, upright beyond them."""
        points = self.points
        marks = sorted((p[1], p[0]) for p in (points.fitting_point, points.near_reference_point) if p is not None)
        return np.interp(np.asarray(y, dtype=float), *np.transpose(marks))

    def weight(self) -> float:
        """Mass in g: density times the integral of the thickness over the outline."""
        x, y, area = self.disc_points()
        return float(self.material.density * np.sum(self.thickness(x, y) * area) / 1000)


def surface_height(surface: Surface, x: ArrayLike, y: ArrayLike) -> Floats:
    """z (mm) of a posed surface over its vertex plane at lens points x, y (mm, any shape); NaN where there is none.

    A tilted surface is met by Newton's method along z: the foot point in the surface frame is corrected by its slopes.
    """
    u, v = np.asarray(x, dtype=float) - surface.decentration[0], np.asarray(y, dtype=float) - surface.decentration[1]
    if surface.tilt == (0.0, 0.0):
        return surface.sag(u, v)
    turn = surface.rotation
    z = np.zeros(np.broadcast(u, v).shape)
    for _ in range(8):
        point = np.stack(np.broadcast_arrays(u, v, z), -1) @ turn
        f, fx, fy, *_ = surface.derivatives(point[..., 0], point[..., 1])
        z = z - (point[..., 2] - f) / (turn[2, 2] - fx * turn[2, 0] - fy * turn[2, 1])
    return z
