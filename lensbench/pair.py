"""Two lenses for one face, as a whole: a PairRequest goes in, maps over the common gaze and the convergence path come out."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .optics.binocular import Fixation, Pair, fixate
from .optics.conventions import Floats, ReadOnlyArrays, Status
from .optics.gaze import direction_from_angles
from .optics.lens import Lens

LOWEST, HIGHEST, STEP = 36.0, -10.0, 1.0  # lowering of the convergence path, degrees

LABELS = {
    "vertical_imbalance": ("Vertical imbalance, + base up R", "cm/m", 1.0),
    "induced_vergence": ("Induced convergence, + as base out", "cm/m", 1.0),
    "mean_power_difference": ("Mean power error, R less L", "D", 1.0),
    "astigmatic_difference": ("Astigmatic difference, R less L", "D", 1.0),
    "magnification_difference": ("Magnification, R over L less 1", "%", 100.0),
    "cyclo_difference": ("Cyclo difference by Listing's law, + excyclo", "deg", float(np.degrees(1))),
}


@dataclass(frozen=True, slots=True, eq=False)
class PairRequest:
    """distance of the fixated points: mm from the cyclopean eye, inf, or "model"; see optics.binocular. samples: along each
    side of the maps; half_angle: of the common gaze, rad. l2: see Fixation.cyclo_difference.
    """

    pair: Pair
    distance: float | str = "model"
    samples: int = 61
    half_angle: float = float(np.radians(30.0))
    l2: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class PairMap(ReadOnlyArrays):
    """values, status (ny, nx) over the cyclopean azimuth (nx,) towards the wearer's left and elevation (ny,), degrees."""

    quantity: str
    label: str
    unit: str
    azimuth: Floats
    elevation: Floats
    values: Floats
    status: NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False)
class PathOnLens(ReadOnlyArrays):
    """The line of sight's way over one lens: points x, y (n,) mm on the front surface, and how far towards the nose (mm) they
    lie from the main meridian through fitting and near reference point. NaN where no ray passes.
    """

    x: Floats
    y: Floats
    off_meridian: Floats


@dataclass(frozen=True, slots=True, eq=False)
class ConvergencePath(ReadOnlyArrays):
    """Both eyes on the face's midline, the gaze lowered step by step: lowering (n,) degrees, distance (n,) mm from the
    cyclopean eye, the way over each lens, vertical imbalance and induced convergence (n,) cm/m.
    """

    lowering: Floats
    distance: Floats
    right: PathOnLens
    left: PathOnLens
    vertical_imbalance: Floats
    induced_vergence: Floats


@dataclass(frozen=True, slots=True, eq=False)
class PairResult:
    """What there is to say of a pair."""

    path: ConvergencePath
    maps: dict[str, PairMap]


def run_pair(request: PairRequest) -> PairResult:
    """Answer a request about a pair. Raises InputError when there is no gaze at which both eyes see through their lenses."""
    angle = np.degrees(request.half_angle) * np.linspace(-1, 1, request.samples)
    azimuth, elevation = (a.ravel() for a in np.meshgrid(angle, angle))
    fixation = _fixation(request, azimuth, elevation)
    if not np.any(fixation.status == Status.OK):
        raise InputError("there is no gaze at which both eyes see through their lenses")
    status = fixation.status.reshape(angle.size, angle.size)
    maps = {
        name: PairMap(name, label, unit, angle, angle, (factor * values).reshape(status.shape), status)
        for (name, (label, unit, factor)), values in zip(LABELS.items(), fixation.balance(request.l2), strict=True)
    }
    return PairResult(_path(request), maps)


def _fixation(request: PairRequest, azimuth: Floats, elevation: Floats) -> Fixation:
    """Both eyes in cyclopean directions of Fick angles in degrees."""
    directions = direction_from_angles(np.radians(azimuth), np.radians(elevation))
    return fixate(request.pair, request.pair.points(directions, request.distance))


def _path(request: PairRequest) -> ConvergencePath:
    lowering = np.arange(HIGHEST, LOWEST + STEP / 2, STEP)
    fixation = _fixation(request, np.zeros(lowering.size), -lowering)
    right, left = fixation.lens_points()
    return ConvergencePath(
        lowering,
        np.linalg.norm(fixation.points, axis=1),
        _on_lens(request.pair.right, right),
        _on_lens(request.pair.left, left),
        fixation.vertical_imbalance(),
        fixation.induced_vergence(),
    )


def _on_lens(lens: Lens, points: Floats) -> PathOnLens:
    x, y = points.T
    nasal = 1.0 if lens.side == "R" else -1.0
    return PathOnLens(x, y, nasal * (x - lens.meridian_x(y)))
