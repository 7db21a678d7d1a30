"""The left lens of a right one, and the other way round: everything mirrored in the wearer's midplane (x to -x)."""

from dataclasses import replace

import numpy as np

from .conventions import Floats
from .eye import Eye, Wear, Wearer
from .kernels import surface as kernel
from .lens import Lens, Order, Outline, Points
from .surfaces import Surface, bins_of


def mirrored(lens: Lens) -> Lens:
    """The lens mirrored: sides, axes (180 - axis), bases, reference points, outline, tilts and decentrations change over."""
    return replace(
        lens,
        front=mirrored_surface(lens.front),
        back=mirrored_surface(lens.back),
        outline=mirrored_outline(lens.outline),
        side="L" if lens.side == "R" else "R",
        points=_mirrored_points(lens.points),
        ordered=None if lens.ordered is None else mirrored_order(lens.ordered),
        verification_power=None if lens.verification_power is None else mirrored_order(lens.verification_power),
    )


def mirrored_wearer(wearer: Wearer) -> Wearer:
    """The same face's other eye, mirrored: the axis of the refraction and the decentration change over."""
    refraction = wearer.eye.refraction * np.array([[1, -1], [-1, 1]])
    eye: Eye = replace(wearer.eye, refraction=refraction)
    dx, dy = wearer.wear.decentration
    wear: Wear = replace(wearer.wear, decentration=(-dx, dy))
    return replace(wearer, eye=eye, wear=wear)


def mirrored_surface(surface: Surface) -> Surface:
    """The surface mirrored: sag f(-x, y), its vertex and its axis on the other side."""
    (dx, dy), (about_x, about_y) = surface.decentration, surface.tilt
    posed = replace(surface, decentration=(-dx, dy), tilt=(about_x, -about_y))
    if surface.kind == kernel.SPLINE:
        return _mirrored_spline(posed)
    p = surface.p.copy()
    if surface.kind in (kernel.TORIC, kernel.BICONIC):
        p[2] = -p[2]
    return replace(posed, p=p)


def _mirrored_spline(surface: Surface) -> Surface:
    """The cells in the opposite order; in each, counted from its middle, the odd powers of x change their sign."""
    breaks = -surface.breaks_x[::-1]
    signs = (-1.0) ** np.arange(surface.cells.shape[3])
    cells = np.ascontiguousarray(surface.cells[:, ::-1] * signs)
    note = f"{surface.note}; mirrored" if surface.note else ""
    return replace(surface, breaks_x=breaks, bins_x=bins_of(breaks), cells=cells, note=note)


def mirrored_outline(outline: Outline) -> Outline:
    """The edge mirrored."""
    angles: Floats = (np.pi - outline.angles) % (2 * np.pi)
    order = np.argsort(angles)
    return Outline((-outline.centre[0], outline.centre[1]), angles[order], outline.radii[order])


def _mirrored_points(points: Points) -> Points:
    other = {name: (-x, y) for name, (x, y) in points.named().items()}
    return Points(**other, near_inset=points.near_inset)


def mirrored_order(order: Order) -> Order:
    """The order mirrored: axis to 180 - axis, base to 180 - base."""
    axis = (180 - order.axis) % 180 or 180.0
    return replace(order, axis=axis, prism_base=(180 - order.prism_base) % 360)
