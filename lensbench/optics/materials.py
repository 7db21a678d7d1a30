"""Lens materials: refractive index at the reference wavelengths, Abbe number V_d and density."""

import re
from dataclasses import dataclass

REFERENCE_LINES = {"d": 587.56, "e": 546.07}  # nm, ISO 7944
# nm: F and C to the d line, F' and C' to the e line
DISPERSION_LINES = {"d": {"blue": 486.13, "red": 656.27}, "e": {"blue": 479.99, "red": 643.85}}


@dataclass(frozen=True, slots=True)
class Material:
    """name; n_d and n_e at 587.56 and 546.07 nm (ISO 7944); Abbe number V_d = (n_d - 1) / (n_F - n_C); density in g/cm3."""

    name: str
    n_d: float
    n_e: float
    abbe: float
    density: float

    def index(self, wavelength: str) -> float:
        """Refractive index at the reference wavelength "d" or "e"."""
        return self.n_d if wavelength == "d" else self.n_e

    def index_at(self, nanometres: float, reference: str = "d") -> float:
        """Refractive index at a wavelength (nm): the index of the reference line, carried on by Cauchy's dispersion
        B / lambda^2 whose B gives the Abbe number V_d between the lines F and C."""
        blue, red, line = DISPERSION_LINES["d"]["blue"], DISPERSION_LINES["d"]["red"], REFERENCE_LINES[reference]
        b = (self.n_d - 1) / self.abbe / (blue**-2 - red**-2)
        return self.index(reference) + b * (nanometres**-2 - line**-2)


# Makers' leaflets and Jalie, Ophthalmic Lenses and Dispensing; index and density vary by maker. All Abbe numbers are V_d;
# Mitsui's leaflets state V_e (F', C') of the MR series: 41 (MR-8), 31 (MR-7, MR-10), 32 (MR-174).
MATERIALS = {
    m.name: m
    for m in (
        Material("CR-39", 1.498, 1.500, 58.0, 1.32),
        Material("Trivex", 1.530, 1.533, 44.0, 1.11),
        Material("polycarbonate", 1.586, 1.591, 30.0, 1.20),
        Material("MR-8", 1.592, 1.5955, 41.0, 1.30),
        Material("MR-7", 1.660, 1.665, 32.0, 1.35),
        Material("MR-10", 1.661, 1.666, 32.0, 1.37),
        Material("MR-174", 1.732, 1.737, 33.0, 1.47),
        Material("crown", 1.523, 1.525, 58.6, 2.54),
    )
}

_OTHER_NAMES = {
    "adc": "CR-39",
    "polycarb": "polycarbonate",
    "pc": "polycarbonate",
    "b270": "crown",
    "crownglass": "crown",
}
_LINES = {"F": 0.48613, "e": 0.54607, "d": 0.58756, "C": 0.65627}  # micrometres


def named_material(name: str) -> Material | None:
    """The material of the table whose name is this one but for case, dashes, blanks and underscores, or None."""
    plain = re.sub(r"[-_ ]", "", name.lower())
    plain = re.sub(r"[-_ ]", "", _OTHER_NAMES.get(plain, plain).lower())
    return next((m for m in MATERIALS.values() if re.sub(r"[-_ ]", "", m.name.lower()) == plain), None)


def material_from_abbe(name: str, n_d: float, abbe: float, density: float | None = None) -> Material:
    """A material of which n_d and the Abbe number V_d are known: n_e by Cauchy's n = A + B / lambda^2 through both.

    density: g/cm3; that of the table's material of the nearest index, if not given.
    """
    f, e, d, c = (_LINES[line] ** -2 for line in "FedC")
    b = (n_d - 1) / (abbe * (f - c))
    nearest = min(MATERIALS.values(), key=lambda m: abs(m.n_d - n_d))
    return Material(name, n_d, n_d + b * (e - d), abbe, nearest.density if density is None else density)
