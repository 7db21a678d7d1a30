"""What there is to say of points that became a surface: rounding, residual, power noise, points refused and missing."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..optics.smoothing import SplineFit
from ..optics.surfaces import power_noise
from .detection import Decision
from .surface_data import Reading

Fact = tuple[str, str, object]
MOST_NAMED = 5
NOISY = 2.0


@dataclass(frozen=True, slots=True)
class Report:
    """source and size in words; pitch, digit (last one written) and step (found between the values) in mm."""

    source: str
    size: str
    pitch: float
    digit: float
    step: float
    reading: Reading
    decision: Decision
    fit: SplineFit

    def facts(self, refused: NDArray[np.bool_], missing: NDArray[np.bool_], remark: str) -> tuple[Fact, ...]:
        """Label, text with units, value; refused and missing points in the file's order."""
        rms = float(np.sqrt(np.nanmean(self.fit.residual**2)))
        rounding = {"digit_mm": self.digit, "step_mm": self.step, "noise_found_mm": self.fit.noise}
        powers = self._noise_powers()
        return (
            ("Points", f"{self.source}: {self.size}", self.size),
            ("Rounding", self._rounding(), rounding),
            ("Fit residual", f"fit residual {rms * 1e6:.3g} nm rms", rms),
            (
                "Power noise",
                self._power_noise(*powers),
                dict(zip(("smoothed_D", "interpolated_D"), powers, strict=True)),
            ),
            ("Points refused", _places(refused, "refused"), np.argwhere(refused) + 1),
            ("Points missing", _places(missing, "missing, filled by the fit"), int(np.count_nonzero(missing))),
            ("Orientation", self.decision.describe() + self._face(), self._decision()),
            *((("Remark", remark, remark),) if remark else ()),
        )

    @staticmethod
    def line(facts: tuple[Fact, ...]) -> str:
        """One line for a surface's note."""
        return "; ".join(text for _, text, _ in facts if text != "none")

    def _rounding(self) -> str:
        text = f"rounded to {self.step:.3g} mm"
        if self.step > 1.01 * self.digit:
            text += f" (written to {self.digit:g} mm)"
        if np.isfinite(self.fit.noise) and self.fit.noise > NOISY * self.step / np.sqrt(12):
            text += f", but the values are noisier: {self.fit.noise * 1e6:.3g} nm rms"
        return text

    def _noise_powers(self) -> tuple[float, float]:
        """Expected rms errors of astigmatism, D: smoothed (noise, and as much again for what smoothing takes), interpolated."""
        smoothed = float(np.sqrt(2)) * 1000 * (self.reading.index - 1) * self.fit.astigmatism
        interpolated = power_noise(self.step, self.pitch, self.reading.index)
        return min(smoothed, interpolated), interpolated

    def _power_noise(self, smoothed: float, interpolated: float) -> str:
        return (
            f"expected power noise {smoothed:.2g} D rms at n = {self.reading.index:g} "
            f"({interpolated:.2g} D if the points were interpolated)"
        )

    def _face(self) -> str:
        return "" if self.reading.face else "; no face is said, taken as a front"

    def _decision(self) -> dict[str, object]:
        d = self.decision
        o = d.orientation
        return {"orientation": o.name, "z_towards": o.z_towards, "side": d.side, "certainty": d.certainty, "why": d.why}


def _places(found: NDArray[np.bool_], what: str) -> str:
    """How many points and where the first of them are, by row and column of a grid, or by number; "none"."""
    where = np.argwhere(found) + 1
    if not len(where):
        return "none"
    named = [f"row {r[0]}, column {r[1]}" if len(r) == 2 else f"point {r[0]}" for r in where[:MOST_NAMED]]
    more = f" and {len(where) - MOST_NAMED} more" if len(where) > MOST_NAMED else ""
    return f"{len(where)} {'point' if len(where) == 1 else 'points'} {what}: {'; '.join(named)}{more}"
