"""A grid of sags read from a file, and how it becomes a smooth surface."""

from dataclasses import dataclass, replace

import numpy as np

from ..errors import InputError
from ..optics.conventions import Floats
from ..optics.surfaces import fitted_grid, power_noise
from .orientation import Orientation
from .surface_data import Fitted, Reading


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

    def fitted(self, reading: Reading) -> Fitted:
        """Smoothing quintic B-spline through the points, counted from the sag at the centre."""
        orientation = Orientation(
            reading.first_point or "top-left", reading.rows or "horizontal", reading.z_towards or "eye"
        )
        z, width, height = self.values, self.width, self.height
        if orientation.rows == "vertical":
            z, width, height = z.T, height, width
        vertical, horizontal = orientation.first_point.split("-")
        z = z[::-1] if vertical == "top" else z
        z = z[:, ::-1] if horizontal == "right" else z
        z = -z if (orientation.z_towards == "eye") != reading.flip_z else z
        if min(z.shape) < 6:
            raise InputError(f"{self.source}: {z.shape[1]} x {z.shape[0]} points are too few; a surface needs 6 x 6")
        x, y = np.linspace(-width / 2, width / 2, z.shape[1]), np.linspace(-height / 2, height / 2, z.shape[0])
        surface = fitted_grid(x, y, z, self.rounding_step, **reading.pose)
        residual = np.std(surface.sag(*np.meshgrid(x, y)) - z)
        note = (
            f"{self.describe(reading.index)}; fit residual {residual * 1e6:.2g} nm rms; first point "
            f"{orientation.first_point}, rows {orientation.rows}, z towards the {orientation.z_towards}"
        )
        return Fitted(replace(surface, note=note), (("Points", note, self.values.shape),))
