"""Lens materials: refractive index at the reference wavelengths, Abbe number and density."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Material:
    """name; n_d and n_e at 587.56 and 546.07 nm (ISO 7944); Abbe number V_d; density in g/cm3."""

    name: str
    n_d: float
    n_e: float
    abbe: float
    density: float

    def index(self, wavelength: str) -> float:
        """Refractive index at the reference wavelength "d" or "e"."""
        return self.n_d if wavelength == "d" else self.n_e


# Makers' leaflets (Mitsui MR series) and Jalie, Ophthalmic Lenses and Dispensing; index and density vary by maker.
MATERIALS = {
    m.name: m
    for m in (
        Material("CR-39", 1.498, 1.500, 58.0, 1.32),
        Material("Trivex", 1.530, 1.533, 44.0, 1.11),
        Material("polycarbonate", 1.586, 1.591, 30.0, 1.20),
        Material("MR-8", 1.592, 1.5955, 41.0, 1.30),
        Material("MR-7", 1.660, 1.665, 31.5, 1.35),
        Material("MR-10", 1.661, 1.666, 31.5, 1.37),
        Material("MR-174", 1.732, 1.737, 32.5, 1.47),
        Material("crown", 1.523, 1.525, 58.6, 2.54),
    )
}
