"""Which way up a surface lies, found from its shape: the sign of z, where the addition is, and which side is nasal.

Assumed of every spectacle lens: both faces are hollow on the eye's side; the power of a progressive lens rises downwards; its
near zone lies towards the nose. Each decision states its evidence as a multiple of the least evidence that is accepted.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats
from .orientation import ALL, Orientation, Towards
from .surface_data import Reading

LEAST_BASE = 0.5
LEAST_ADDITION = 0.4
LEAST_RATIO = 1.5
LEAST_INSET = 0.4
SAME_POWER = 0.04
SAME_SLOPE = 5e-4
_DEGREE = 8
_HALF_COUNT = 12
_AT = np.linspace(-1, 1, 2 * _HALF_COUNT + 1)
MOST_POINTS, LEAST_POINTS = 1500, 60


class Decision(NamedTuple):
    """certainty: the weakest evidence used, as a multiple of the least that is accepted; inf where none was needed."""

    orientation: Orientation
    side: str
    certainty: float
    why: str

    def describe(self) -> str:
        """The decision in words."""
        o = self.orientation
        sure = "" if np.isinf(self.certainty) else f", certainty {self.certainty:.1f} (1 is the least accepted)"
        side = f", side {self.side}" if self.side else ""
        return f"orientation {o.name}, z towards the {o.z_towards}{side}: {self.why}{sure}"


@dataclass(frozen=True, slots=True)
class Shape:
    """A surface in its file's frame, u along columns and v along rows, on (k, k) samples of a square centred on the grid.

    half: half side, mm. mean, uu, uv, vv: mean curvature and second derivatives, 1/mm; slope (2,) at the centre; inside:
    which samples lie in the inscribed circle. error: standard error of the mean curvature, 1/mm.
    """

    half: float
    mean: Floats
    second: Floats
    slope: Floats
    inside: np.ndarray
    error: float


def shape_of(u: Floats, v: Floats, z: Floats, sigma: float) -> Shape:
    """The polynomial of degree 8 through points u, v, z (n,), mm, with rms noise sigma, mm, over the middle of the points."""
    u, v = _centred(u), _centred(v)
    half = float(min(24.0, 0.95 * min(np.ptp(u), np.ptp(v)) / 2))
    near = np.flatnonzero((np.abs(u) <= 1.2 * half) & (np.abs(v) <= 1.2 * half))
    near = near[:: max(1, near.size // MOST_POINTS)] if near.size >= LEAST_POINTS else np.arange(u.size)
    design = _terms(u[near] / half, v[near] / half)
    spread = np.linalg.pinv(design.T @ design, hermitian=True)
    coefficients = spread @ (design.T @ z[near])
    fu, fv, uu, uv, vv = (r @ coefficients / half**order for r, order in zip(_samples(), (1, 1, 2, 2, 2), strict=True))
    w = 1 + fu**2 + fv**2
    mean = ((1 + fv**2) * uu - 2 * fu * fv * uv + (1 + fu**2) * vv) / (2 * w**1.5)
    laplacian = (_samples()[2] + _samples()[4])[4::9, 4::9].reshape(-1, design.shape[1]) / (2 * half**2)
    error = sigma * float(np.sqrt(np.mean(np.einsum("ij,jk,ik->i", laplacian, spread, laplacian))))
    middle = (_HALF_COUNT, _HALF_COUNT)
    inside = np.hypot(*np.meshgrid(_AT, _AT)) <= 1.0
    return Shape(half, mean, np.array([uu, uv, vv]) / np.sqrt(w), np.array([fu[middle], fv[middle]]), inside, error)


def _centred(at: Floats) -> Floats:
    """Coordinates from their own origin if it lies in the middle half of them, else from their middle."""
    middle = float(at.max() + at.min()) / 2
    return at - middle if abs(middle) > np.ptp(at) / 4 else at


@lru_cache(maxsize=1)
def _samples() -> Floats:
    """Legendre terms' slopes and second derivatives (5, k, k, terms) on the samples of a Shape with half side 1."""
    u, v = (a.ravel() for a in np.meshgrid(_AT, _AT))
    return np.array(
        [_terms(u, v, *o).reshape(_AT.size, _AT.size, -1) for o in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))]
    )


def _terms(u: Floats, v: Floats, du: int = 0, dv: int = 0) -> Floats:
    """Products of Legendre polynomials (n, terms) up to the total degree, or their derivatives."""
    legendre = np.polynomial.legendre
    unit = np.eye(_DEGREE + 1)
    pu, pv = (legendre.legval(at, legendre.legder(unit, m) if m else unit).T for at, m in ((u, du), (v, dv)))
    return np.stack([pu[:, i] * pv[:, j] for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)], axis=1)


def decide(source: str, shape: Shape, reading: Reading, stated: Orientation | None) -> Decision:
    """How the surface lies, as far as `reading` leaves it open. stated: what the format itself says, if it does.

    Raises InputError where the shape cannot tell between orientations that matter.
    """
    case = _Case(source, shape, reading, stated, *_sign(source, shape, reading, stated))
    candidates = case.candidates()
    if len(candidates) == 1:
        return case.decided(candidates, "as told" + case.objection(candidates[0]))
    if case.all_same(candidates):
        return case.decided(candidates, "any order of the points gives the same surface")
    power = case.power()
    rise = _rise(power)
    along, across = float(np.abs(rise).max()), float(np.abs(rise).min())
    least = max(LEAST_ADDITION, 4 * case.dioptres * shape.error)
    evidence = min(along / least, along / max(across, 1e-9) / LEAST_RATIO)
    if evidence < 1:
        return case.as_stated(candidates)
    down = [o for o in candidates if (o.matrix() @ rise)[1] < -along / 2] or candidates
    why = f"power rises by {along:.2f} D downwards over {1.4 * shape.half:.0f} mm"
    if case.all_same(down):
        return case.decided(down, why, evidence)
    return case.by_near_zone([(_near_shift(shape, o.to_lens(power)), o) for o in down], why, evidence)


def _sign(source: str, shape: Shape, reading: Reading, stated: Orientation | None) -> tuple[Towards, float, str]:
    """The side to which z counts, its evidence, and the reason."""
    dioptres = 1000 * (reading.index - 1)
    base = float(np.median(shape.mean[shape.inside])) * dioptres
    evidence = abs(base) / max(LEAST_BASE, 4 * dioptres * shape.error)
    bent = np.sqrt(np.mean(shape.second[:, shape.inside] ** 2)) * dioptres
    towards: Towards = "eye" if base > 0 else "scene"
    why = f", base curve {abs(base):.2f} D"
    if reading.z_towards:
        towards, evidence, why = reading.z_towards, np.inf, ""
    elif bent < SAME_POWER and np.abs(shape.slope).max() < SAME_SLOPE:
        evidence, why = np.inf, ", a plane"
    elif evidence < 1 and stated:
        towards, evidence, why = stated.z_towards, np.inf, ", z as the format says"
    elif evidence < 1:
        raise InputError(
            f"{source}: curved by only {abs(base):.2f} D, so the shape cannot tell to which side z counts positive: "
            "say z_towards in a lens file, or --z-towards eye or scene"
        )
    if reading.flip_z:
        towards, why = ("scene" if towards == "eye" else "eye"), f"{why}, z flipped"
    return towards, evidence, why


class _Case(NamedTuple):
    """What is known while the order of the points is sought: sign_evidence and sign_why say how z_towards was found."""

    source: str
    shape: Shape
    reading: Reading
    stated: Orientation | None
    z_towards: Towards
    sign_evidence: float
    sign_why: str

    @property
    def dioptres(self) -> float:
        """D per 1/mm of curvature."""
        return 1000 * (self.reading.index - 1)

    def candidates(self) -> list[Orientation]:
        """The orders that the reading leaves open, the one that the format states first."""
        r = self.reading
        found = [
            o._replace(z_towards=self.z_towards)
            for o in ALL
            if r.first_point in (None, o.first_point) and r.rows in (None, o.rows)
        ]
        return sorted(found, key=lambda o: self.stated is None or o[:2] != self.stated[:2])

    def power(self) -> Floats:
        """Power that the surface adds to the lens, D, on the samples of its shape."""
        sign = (1 if self.z_towards == "eye" else -1) * (-1 if self.reading.face == "B" else 1)
        return sign * self.dioptres * self.shape.mean

    def all_same(self, orders: list[Orientation]) -> bool:
        """Whether these orders of the points give the same surface within SAME_POWER, D rms."""
        least = max(SAME_POWER, 4 * self.dioptres * self.shape.error)
        slope, second = _turned(self.shape, orders[0])
        for o in orders[1:]:
            other_slope, other = _turned(self.shape, o)
            power = self.dioptres * np.sqrt(np.mean((second - other)[:, self.shape.inside] ** 2))
            if power > least or np.abs(slope - other_slope).max() > SAME_SLOPE:
                return False
        return True

    def objection(self, told: Orientation) -> str:
        """What the shape says against an orientation that was told; "" if nothing."""
        try:
            found = decide(
                self.source, self.shape, Reading(self.reading.side, self.reading.face, self.reading.index), None
            )
        except InputError:
            return ""
        o = found.orientation
        if o.z_towards == told.z_towards and self.all_same([told, o]):
            return ""
        return f", although the shape speaks for {o.name}, z towards the {o.z_towards}"

    def decided(self, orders: list[Orientation], why: str, evidence: float = np.inf, side: str = "") -> Decision:
        """The first of these orders."""
        certainty = float(min(evidence, self.sign_evidence))
        return Decision(orders[0], side or self.reading.side, certainty, why + self.sign_why)

    def as_stated(self, orders: list[Orientation]) -> Decision:
        """What the format says, for a shape that cannot tell. Raises InputError where the format says nothing."""
        if self.stated is not None and orders[0][:2] == self.stated[:2]:
            return self.decided(orders, "as the format says; the shape cannot tell")
        raise InputError(
            f"{self.source}: the shape cannot tell the order of the points, and it matters: say --orientation "
            "(top-left-rows, ...), or first_point and rows in a lens file"
        )

    def by_near_zone(self, shifts: list[tuple[float, Orientation]], why: str, evidence: float) -> Decision:
        """The order with the near zone towards the nose. shifts: how far towards +x it lies (mm) in each."""
        inset, orders = abs(shifts[0][0]), [o for _, o in shifts]
        names = " or ".join(o.name for o in orders)
        if inset < LEAST_INSET:
            raise InputError(
                f"{self.source}: the near zone lies {inset:.2f} mm from the middle, which does not tell the nose's side: say "
                f"the order of the points, {names} (--orientation, or first_point and rows in a lens file)"
            )
        evidence, why = min(evidence, inset / LEAST_INSET), f"{why}, near zone {inset:.1f} mm towards the nose"
        side = self.reading.side
        if side:
            nasal = [o for shift, o in shifts if (shift > 0) == (side == "R")] or orders
            return self.decided(nasal, why, evidence)
        if self.stated is not None and orders[0][:2] == self.stated[:2]:
            return self.decided(orders, why, evidence, "R" if shifts[0][0] > 0 else "L")
        raise InputError(
            f"{self.source}: says no side, and without it the near zone does not tell left from right: say --side R or L, "
            f"or the order of the points, {names} (--orientation)"
        )


def _turned(shape: Shape, o: Orientation) -> tuple[Floats, Floats]:
    """Slope (2,) and second derivatives (xx, xy, yy) in the lens frame of an orientation."""
    m = o.matrix()
    uu, uv, vv = (o.to_lens(a) for a in shape.second)
    t = np.einsum("ai,bj,ij...->ab...", m, m, np.array([[uu, uv], [uv, vv]]))
    return m @ shape.slope, np.array([t[0, 0], t[0, 1], t[1, 1]])


def _rise(power: Floats) -> Floats:
    """Rise (2,) of the power along u and v, D, between two points 0.7 of the half side from the centre, by least squares."""
    u, v = np.meshgrid(_AT, _AT)
    inside = np.hypot(u, v) <= 0.85
    p = power[inside] - power[inside].mean()
    return np.array([np.sum(p * a[inside]) / np.sum(a[inside] ** 2) for a in (u, v)]) * 1.4


def _near_shift(shape: Shape, power: Floats) -> float:
    """How far (mm, towards +x) the power over the lower half lies from the middle, by least squares on its even part.

    Only what differs between opposite points counts: that leaves out a torus or asphere beneath. power: (k, k), rows of
    rising y.
    """
    x, y = np.meshgrid(_AT, _AT)
    progressive = power - power[::-1, ::-1]
    even, odd = (progressive + progressive[:, ::-1]) / 2, (progressive - progressive[:, ::-1]) / 2
    slope = np.gradient(even, _AT * shape.half, axis=1)
    low = (y < -0.25) & (np.hypot(x, y) < 0.95) & (np.abs(x) < 0.6)
    return float(-np.sum(odd[low] * slope[low]) / max(np.sum(slope[low] ** 2), 1e-12))
