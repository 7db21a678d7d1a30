"""A grid of sags read from a file, and how it becomes a smooth surface."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats
from ..optics.surfaces import Surface, fitted_grid, power_noise


@dataclass(frozen=True, slots=True, eq=False)
class PointGrid:
    """Sags as the file has them. values (rows, columns): mm, in the file's order and sign. rounding_step: mm, last digit.

    width, height: extent along the file's columns and rows, mm; the centre of the grid is the surface's origin.
    side "R" | "L" | "", face "F" | "B" | "": as the file says.
    """

    source: str
    values: Floats
    width: float
    height: float
    rounding_step: float
    side: str = ""
    face: str = ""

    @property
    def pitch(self) -> tuple[float, float]:
        """Spacing along the columns and rows, mm."""
        rows, columns = self.values.shape
        return self.width / (columns - 1), self.height / (rows - 1)

    def describe(self, index: float) -> str:
        """One line: size, pitch, rounding step and the power noise to expect at a refractive index."""
        noise = power_noise(self.rounding_step, min(self.pitch), index)
        rows, columns = self.values.shape
        return (
            f"{self.source}: {columns} x {rows} points, pitch {self.pitch[0]:g} x {self.pitch[1]:g} mm, rounded to "
            f"{self.rounding_step:g} mm: expected power noise at most {noise:.2g} D rms at n = {index:g}"
        )

    def surface(self, first_point: str, rows: str, z_towards: str, index: float, **pose: Any) -> Surface:
        """Smoothing quintic B-spline through the points, counted from the sag at the centre.

        first_point: corner of the first value, seen from the front ("top-left", ...); rows: "horizontal" or "vertical";
        z_towards: the side ("eye" or "scene") to which the file counts positive.
        """
        z = self.values if rows == "horizontal" else self.values.T
        width, height = (self.width, self.height) if rows == "horizontal" else (self.height, self.width)
        vertical, horizontal = first_point.split("-")
        z = z[::-1] if vertical == "top" else z
        z = z[:, ::-1] if horizontal == "right" else z
        z = -z if z_towards == "eye" else z
        if min(z.shape) < 6:
            raise InputError(f"{self.source}: {z.shape[1]} x {z.shape[0]} points are too few; a surface needs 6 x 6")
        x, y = np.linspace(-width / 2, width / 2, z.shape[1]), np.linspace(-height / 2, height / 2, z.shape[0])
        surface = fitted_grid(x, y, z, self.rounding_step, **pose)
        residual = np.std(surface.sag(*np.meshgrid(x, y)) - z)
        note = f"{self.describe(index)}; fit residual {residual * 1e6:.2g} nm rms; first point {first_point}, "
        return replace(surface, note=f"{note}rows {rows}, z towards the {z_towards}")
