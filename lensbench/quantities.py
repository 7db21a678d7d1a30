"""What a map can show: each quantity as a function of the gaze field, the object distance and the accommodation."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .optics.bundle import Wavefront
from .optics.chromatic import transverse_chromatic_aberration
from .optics.conventions import Floats, Status, astigmatism, mean_power, sphere_cylinder_axis
from .optics.distortion import anisotropy, area_magnification, rotation, skew, swim
from .optics.field import Accommodation, GazeField, ellipse_diagonal
from .optics.gaze import worn_pose
from .optics.lens import Lens
from .optics.lensmeter import VertexPower, back_vertex_power, surface_power


@dataclass(frozen=True, slots=True)
class Quantity:
    """label and unit for the reader; values (n,) from a gaze field, the object distance and the accommodation rule.

    about: said of a map instead of the object distance, where that does not matter. missing: why a ray that passes may
    have no value.
    """

    label: str
    unit: str
    values: Callable[[GazeField, Any, Accommodation], Floats]
    about: str = ""
    missing: Status = Status.NO_VALUE


_BY_LENSMETER = "back surface on the stop, axis along its normal"
_OF_SURFACES = "by the curvatures alone"


QUANTITIES = {
    "mean_power": Quantity("As-worn mean power", "D", lambda f, s, a: mean_power(f.as_worn_matrix(s))),
    "astigmatism": Quantity("As-worn astigmatism", "D", lambda f, s, a: astigmatism(f.as_worn_matrix(s))),
    "sphere": Quantity("As-worn sphere", "D", lambda f, s, a: f.as_worn_power(s).sphere),
    "cylinder": Quantity("As-worn cylinder", "D", lambda f, s, a: f.as_worn_power(s).cylinder),
    "axis": Quantity("As-worn axis", "deg", lambda f, s, a: f.as_worn_power(s).axis),
    "mean_error": Quantity("Mean power error", "D", lambda f, s, a: mean_power(f.power_error(s))),
    "astigmatic_error": Quantity("Astigmatic error", "D", lambda f, s, a: astigmatism(f.power_error(s))),
    "residual_mean": Quantity("Residual mean defocus", "D", lambda f, s, a: mean_power(f.residual_defocus(s, a))),
    "accommodation": Quantity("Accommodation in use", "D", lambda f, s, a: f.accommodation(s, a)),
    "defocus": Quantity("Defocus, rms blur diameter", "arcmin", lambda f, s, a: np.degrees(f.defocus(s, a)) * 60),
    "ellipse_diagonal": Quantity(
        "Diagonal 2|ε| of the ellipse of confusion, seen from the lens",
        "arcmin",
        lambda f, s, a: np.degrees(ellipse_diagonal(f.angular_blur(s, a))) * 60,
    ),
    "prism": Quantity("Prism", "cm/m", lambda f, s, a: f.prism().prism),
    "prism_horizontal": Quantity(
        "Horizontal prism, + base to the wearer's left", "cm/m", lambda f, s, a: f.prism_components()[:, 0]
    ),
    "prism_vertical": Quantity("Vertical prism, + base up", "cm/m", lambda f, s, a: f.prism_components()[:, 1]),
    "magnification": Quantity("Magnification", "x", lambda f, s, a: area_magnification(f.magnification(s))),
    "magnification_anisotropy": Quantity(
        "Greatest over least magnification, less 1", "%", lambda f, s, a: 100 * anisotropy(f.magnification(s))
    ),
    "skew": Quantity("Skew of a right angle", "deg", lambda f, s, a: np.degrees(skew(f.magnification(s)))),
    "image_rotation": Quantity(
        "Rotation of the image", "deg", lambda f, s, a: np.degrees(rotation(f.magnification(s)))
    ),
    "swim": Quantity("Swim", "%/deg", lambda f, s, a: np.radians(100 * swim(f, s))),
    "transverse_chromatic": Quantity(
        "Transverse chromatic aberration, blue to red line",
        "cm/m",
        lambda f, s, a: np.linalg.norm(transverse_chromatic_aberration(f, s), axis=1),
    ),
    "thickness": Quantity("Thickness", "mm", lambda f, s, a: _thickness(f), "along the lens's axis"),
    # by real rays through the whole pupil
    "defocus_by_real_rays": Quantity(
        "Rms blur diameter by real rays",
        "arcmin",
        lambda f, s, a: np.degrees(_wavefront(f, s, a).defocus()) * 60,
        missing=Status.BUNDLE_CUT,
    ),
    "defocus_left_out": Quantity(
        "Rms blur diameter, real rays less first order",
        "arcmin",
        lambda f, s, a: np.degrees(_wavefront(f, s, a).defocus() - f.defocus(s, a)) * 60,
        missing=Status.BUNDLE_CUT,
    ),
    "higher_order_rms": Quantity(
        "Higher-order aberrations, rms",
        "µm",
        lambda f, s, a: _wavefront(f, s, a).higher_order_rms(),
        missing=Status.BUNDLE_CUT,
    ),
    "coma": Quantity(
        "Coma, rms of both terms",
        "µm",
        lambda f, s, a: np.hypot(*_zernike(f, s, a)[:, 7:9].T),
        missing=Status.BUNDLE_CUT,
    ),
    "trefoil": Quantity(
        "Trefoil, rms of both terms",
        "µm",
        lambda f, s, a: np.hypot(*_zernike(f, s, a)[:, [6, 9]].T),
        missing=Status.BUNDLE_CUT,
    ),
    "spherical_aberration": Quantity(
        "Spherical aberration", "µm", lambda f, s, a: _zernike(f, s, a)[:, 12], missing=Status.BUNDLE_CUT
    ),
    # by focimeter and of the surfaces: no eye, no position of wear, no object distance
    "lensmeter_mean_power": Quantity(
        "Lensmeter mean power", "D", lambda f, s, a: mean_power(_by_lensmeter(f).power), _BY_LENSMETER
    ),
    "lensmeter_astigmatism": Quantity(
        "Lensmeter astigmatism", "D", lambda f, s, a: astigmatism(_by_lensmeter(f).power), _BY_LENSMETER
    ),
    "lensmeter_sphere": Quantity(
        "Lensmeter sphere", "D", lambda f, s, a: sphere_cylinder_axis(_by_lensmeter(f).power).sphere, _BY_LENSMETER
    ),
    "lensmeter_cylinder": Quantity(
        "Lensmeter cylinder", "D", lambda f, s, a: sphere_cylinder_axis(_by_lensmeter(f).power).cylinder, _BY_LENSMETER
    ),
    "lensmeter_axis": Quantity(
        "Lensmeter axis", "deg", lambda f, s, a: sphere_cylinder_axis(_by_lensmeter(f).power).axis, _BY_LENSMETER
    ),
    "lensmeter_prism": Quantity(
        "Lensmeter prism", "cm/m", lambda f, s, a: np.hypot(*_by_lensmeter(f).prism.T), _BY_LENSMETER
    ),
    "lensmeter_prism_horizontal": Quantity(
        "Lensmeter horizontal prism, + base to the wearer's left",
        "cm/m",
        lambda f, s, a: _by_lensmeter(f).prism[:, 0],
        _BY_LENSMETER,
    ),
    "lensmeter_prism_vertical": Quantity(
        "Lensmeter vertical prism, + base up", "cm/m", lambda f, s, a: _by_lensmeter(f).prism[:, 1], _BY_LENSMETER
    ),
    "surface_mean_power": Quantity(
        "Mean surface power, front + back", "D", lambda f, s, a: mean_power(_surface_power(f, 1, 1)), _OF_SURFACES
    ),
    "surface_astigmatism": Quantity(
        "Surface astigmatism, front + back", "D", lambda f, s, a: astigmatism(_surface_power(f, 1, 1)), _OF_SURFACES
    ),
    "front_surface_mean_power": Quantity(
        "Front mean surface power", "D", lambda f, s, a: mean_power(_surface_power(f, 1, 0)), _OF_SURFACES
    ),
    "front_surface_astigmatism": Quantity(
        "Front surface astigmatism", "D", lambda f, s, a: astigmatism(_surface_power(f, 1, 0)), _OF_SURFACES
    ),
    "back_surface_mean_power": Quantity(
        "Back mean surface power", "D", lambda f, s, a: mean_power(_surface_power(f, 0, 1)), _OF_SURFACES
    ),
    "back_surface_astigmatism": Quantity(
        "Back surface astigmatism", "D", lambda f, s, a: astigmatism(_surface_power(f, 0, 1)), _OF_SURFACES
    ),
}


def _wavefront(field: GazeField, distance: Any, rule: Accommodation) -> Wavefront:
    return field.bundle(distance, rule).wavefront()


def _zernike(field: GazeField, distance: Any, rule: Accommodation) -> Floats:
    return _wavefront(field, distance, rule).zernike()


def _lens_points(field: GazeField) -> tuple[Lens, Floats, Floats]:
    """The lens and the points x, y (n,) mm of its front surface that the chief rays pass."""
    lens = field.lens
    assert lens is not None
    point = worn_pose(lens, field.wearer.wear).to_lens(field.origin)
    return lens, point[:, 0], point[:, 1]


def _thickness(field: GazeField) -> Floats:
    lens, x, y = _lens_points(field)
    return lens.thickness(x, y)


def _by_lensmeter(field: GazeField) -> VertexPower:
    return back_vertex_power(*_lens_points(field))


def _surface_power(field: GazeField, front: int, back: int) -> Floats:
    """Surface power (n, 2, 2), D, of the front, the back (in its usual sign), or the sum of both at one lens point."""
    lens, x, y = _lens_points(field)
    return front * surface_power(lens.front, x, y, lens.index) - back * surface_power(lens.back, x, y, lens.index)
