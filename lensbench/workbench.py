"""The application layer: a Request (a lens, a wearer, one layer, a scene) goes in, a Result of plain arrays comes out.

The command line, the report and the window all build Requests and call run(); none of them computes. No Qt, no VTK.
"""

from dataclasses import replace
from functools import lru_cache, singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import seen
from .against import deviation
from .errors import InputError
from .formats.tolerance_file import load_tolerances
from .layers import (
    AgainstLayer,
    ConoidLayer,
    DefocusLayer,
    DefocusView,
    Deviation,
    DistortionGrid,
    DistortionLayer,
    EllipseLayer,
    EllipseSheet,
    Layer,
    LensMap,
    MapLayer,
    PointReading,
    PointsLayer,
    Probe,
    ProbeLayer,
    Profile,
    ProfileLayer,
    RealRays,
    RealRaysLayer,
    Request,
    SeenScene,
    VerificationLayer,
    ViewLayer,
    VoxelField,
    VoxelLayer,
)
from .optics.compensation import verification_power
from .optics.conoid import GazeConoids, gaze_conoids
from .optics.conventions import Floats, Status, astigmatism, mean_power, rotation_xy
from .optics.distortion import seen_chart
from .optics.eye import Eye, Wear, Wearer
from .optics.field import Accommodation, GazeField, ellipse
from .optics.gaze import (
    GazeGrid,
    angles_from_direction,
    direction_from_angles,
    look_through,
    trace,
)
from .optics.lens import Lens, Order, Outline
from .optics.object_distance import model_distance
from .optics.ordered import wearer_as_ordered
from .optics.tolerances import Verification, verification
from .optics.voxels import blur_on_planes, distance_to_plane, ndc_blur
from .probe import read_probe
from .quantities import QUANTITIES, Quantity
from .readings import point_readings
from .real_rays import compare
from .scenes.scene import Scene

# ---- who looks, and where to ----


def assumed_wearer(lens: Lens) -> Wearer:
    """The wearer whom the lens's order suggests, for when none is given; see wearer_as_ordered."""
    name = "assumed from the order: refraction as ordered, accommodation to match the addition"
    return wearer_as_ordered(lens.ordered or Order(), name=name)


MOST_VOXELS = 100_000_000


def look(name: str | None, lens: Lens, wearer: Wearer, scene: Scene) -> tuple[float, float]:
    """Azimuth and elevation (rad) of the line from the eye's centre of rotation to what the scene's look names.

    name None: the scene's first look. Raises InputError for a look that the scene does not have.
    """
    name = next(iter(scene.looks)) if name is None else name
    if name not in scene.looks:
        raise InputError(f"look: the scene {scene.name!r} has no {name!r}; it has {', '.join(scene.looks)}")
    x, y, z = scene.looks[name].target
    target = np.array([x + _midline(lens, wearer), y, z])
    azimuth, elevation = angles_from_direction(target - wearer.centre_of_rotation)
    return float(azimuth), float(elevation)


def _midline(lens: Lens, wearer: Wearer) -> float:
    """x (mm, wear frame) of the face's midline: towards the nose."""
    return wearer.wear.pupillary_distance if lens.side == "R" else -wearer.wear.pupillary_distance


# ---- run ----


def run(request: Request) -> Any:
    """Answer one request; raises InputError when the request lacks what its layer needs."""
    return _answer(request.layer, request)


@singledispatch
def _answer(layer: Layer, request: Request) -> Any:
    raise TypeError(f"no layer of type {type(layer).__name__}")


def _needed_lens(request: Request) -> Lens:
    if request.lens is None:
        raise InputError(f"a {type(request.layer).__name__} needs a lens: the naked eye has none")
    return request.lens


def _needed_scene(request: Request) -> Scene:
    """The scene as it stands before this eye: a scene is centred on the face's midline (without a lens: on the eye)."""
    if request.scene is None:
        raise InputError("this needs a scene: name one, or give an object distance")
    return _moved(request.scene, _midline(request.lens, request.wearer)) if request.lens else request.scene


@lru_cache(maxsize=4)
def _moved(scene: Scene, x: float) -> Scene:
    return scene.moved(x)


@_answer.register
def lens_map(layer: MapLayer, request: Request) -> LensMap:
    """A quantity over the front surface, within the outline."""
    lens, quantity = _needed_lens(request), _quantity(layer.quantity)
    x, y, inside, field = sampled(lens, request.wearer, layer.samples)
    distance = _object_distance(layer.distance, field, request)
    values = np.full(inside.size, np.nan)
    values[inside] = np.where(field.status == Status.OK, quantity.values(field, distance, layer.accommodation), np.nan)
    status = np.full(inside.size, np.int8(Status.OUTSIDE_OUTLINE))
    status[inside] = field.status
    status[np.isnan(values) & (status == Status.OK)] = quantity.missing
    shape = (y.size, x.size)
    return LensMap(layer.quantity, quantity.label, quantity.unit, x, y, values.reshape(shape), status.reshape(shape))


def _quantity(name: str) -> Quantity:
    if name not in QUANTITIES:
        raise InputError(f"unknown quantity {name!r}; there are {', '.join(QUANTITIES)}")
    return QUANTITIES[name]


def sampled(lens: Lens, wearer: Wearer, samples: int) -> tuple[Floats, Floats, NDArray[np.bool_], GazeField]:
    """Coordinates x (nx,), y (ny,) mm over the front surface, about `samples` along the longer side; which of the ny * nx
    lie within the outline; and the field of the gazes through those. Raises InputError where no ray passes."""
    x, y, inside, field = _map_field(lens, *_geometry(wearer), samples)
    return x, y, inside, replace(field, wearer=wearer)


def _geometry(wearer: Wearer) -> tuple[Wear, float, float]:
    """What of a wearer decides which way the rays go: position of wear, centre of rotation and entrance pupil."""
    return wearer.wear, wearer.eye.centre_of_rotation, wearer.eye.entrance_pupil


@lru_cache(maxsize=4)
def _map_field(
    lens: Lens, wear: Wear, centre_of_rotation: float, entrance_pupil: float, samples: int
) -> tuple[Floats, Floats, NDArray[np.bool_], GazeField]:
    """As `sampled`, for any refraction, accommodation and pupil. Kept for the next map of the lens in this position of
    wear: all quantities are algebra on one trace.
    """
    x, y = _square_samples(lens.outline, samples)
    px, py = (a.ravel() for a in np.meshgrid(x, y))
    inside = lens.outline.contains(px, py)
    eye = Eye(centre_of_rotation=centre_of_rotation, entrance_pupil=entrance_pupil)
    field = look_through(lens, Wearer(eye, wear), px[inside], py[inside])
    _some_ray_passes(field)
    for array in (x, y, inside):
        array.setflags(write=False)
    return x, y, inside, field


def _some_ray_passes(field: GazeField) -> None:
    if np.any(field.status == Status.OK):
        return
    reasons = " and ".join(sorted({Status(s).name.lower().replace("_", " ") for s in field.status}))
    raise InputError(
        f"no line of sight passes through this lens as worn ({reasons}): check the decentration, tilts and radii"
    )


def _square_samples(outline: Outline, samples: int) -> tuple[Floats, Floats]:
    """Coordinates over the outline's box, equally spaced in x and y, with about `samples` along the longer side."""
    x0, x1, y0, y1 = outline.box
    pitch = max(x1 - x0, y1 - y0) / (samples - 1)
    centres = (x0 + x1) / 2, (y0 + y1) / 2
    halves = round((x1 - x0) / pitch / 2), round((y1 - y0) / pitch / 2)
    return tuple(c + pitch * np.arange(-h, h + 1) for c, h in zip(centres, halves, strict=True))  # type: ignore[return-value]


def _object_distance(distance: float | str, field: GazeField, request: Request) -> Any:
    if distance == "model":
        return model_distance(field)
    if distance != "scene":
        return distance
    from .scenes.cast import first_hit

    return first_hit(_needed_scene(request), field.origin, field.direction)


@_answer.register
def meridian_profile(layer: ProfileLayer, request: Request) -> Profile:
    """As-worn power from the lower to the upper edge along the meridian through the reference points."""
    lens = _needed_lens(request)
    _, _, y0, y1 = lens.outline.box
    y = np.linspace(y0, y1, layer.samples)
    x = lens.meridian_x(y)
    field = look_through(lens, request.wearer, x, y)
    _some_ray_passes(field)
    ok = field.status == Status.OK
    x, y, power = x[ok], y[ok], field.as_worn_matrix(_object_distance(layer.distance, field, request))[ok]
    mean, astig = mean_power(power), astigmatism(power)
    return Profile(x, y, mean, mean - astig / 2, mean + astig / 2, astig)


@_answer.register
def reference_readings(layer: PointsLayer, request: Request) -> tuple[PointReading, ...]:
    """Readings at the reference points that the lens names, against its order."""
    return point_readings(_needed_lens(request), request.wearer)


@_answer.register
def verified(layer: VerificationLayer, request: Request) -> Verification | None:
    """Focimeter readings against the verification power or the order, and what the order is verified as in this wear; None
    for a lens without either."""
    lens = _needed_lens(request)
    found = verification(lens, layer.tolerances or load_tolerances())
    if found is None or lens.ordered is None:
        return found
    try:
        return replace(found, compensated=verification_power(lens, request.wearer, lens.ordered).verification_power)
    except InputError:
        return found


@_answer.register
def real_ray_checks(layer: RealRaysLayer, request: Request) -> RealRays:
    """First order against real rays over the lens."""
    _, _, _, field = sampled(_needed_lens(request), request.wearer, layer.samples)
    return compare(field, layer, lambda distance, rays: _object_distance(distance, rays, request))


@_answer.register
def against_measured(layer: AgainstLayer, request: Request) -> Deviation:
    """Measured less designed power."""
    return deviation(_needed_lens(request), request.wearer, layer)


@_answer.register
def distortion_grid(layer: DistortionLayer, request: Request) -> DistortionGrid:
    """A chart of upright lines as the turning eye sees it."""
    per_line = layer.lines * layer.fineness - layer.fineness + 1
    tangents = np.tan(layer.half_angle) * np.linspace(-1, 1, per_line)
    at = np.stack(np.meshgrid(tangents, tangents), axis=-1)
    chart = seen_chart(request.lens, request.wearer, at.reshape(-1, 2), layer.depth)
    if not np.any(chart.status == Status.OK):
        raise InputError("no ray from the chart passes the lens")
    return DistortionGrid(layer, at, chart.apparent.reshape(at.shape), chart.status.reshape(at.shape[:2]))


@_answer.register
def ellipse_sheets(layer: EllipseLayer, request: Request) -> tuple[EllipseSheet, ...]:
    """Ellipses of confusion on planes straight ahead."""
    grid = GazeGrid(layer.n, layer.n, layer.half_angle, layer.half_angle)
    field = trace(request.lens, request.wearer, grid)
    _some_ray_passes(field)
    return tuple(_sheet(field, depth, layer.accommodation) for depth in layer.depths)


def _sheet(field: GazeField, depth: float, rule: Accommodation) -> EllipseSheet:
    distance = distance_to_plane(field, field.wearer.corneal_apex + depth)
    used = field.accommodation(distance, rule)
    blur = field.blur(distance, used)
    centre = field.origin + distance[:, None] * field.direction
    spokes = np.swapaxes(field.frame[:, :2], 1, 2) @ blur
    return EllipseSheet(depth, centre, spokes, *ellipse(blur), used, field.status)


@_answer.register
def conoids(layer: ConoidLayer, request: Request) -> GazeConoids:
    """The spread of light along one gaze, relaxed, tense and as the eye accommodates."""
    field = trace(request.lens, request.wearer, direction_from_angles([layer.azimuth], [layer.elevation]))
    known = field.status[0] == Status.OK
    distance = np.broadcast_to(_object_distance(layer.distance, field, request), 1)[0] if known else np.nan
    return gaze_conoids(field, float(distance), layer.accommodation)


@_answer.register
def voxel_field(layer: VoxelLayer, request: Request) -> VoxelField:
    """The blur field of the paper: one matrix a voxel."""
    if min(layer.nx, layer.ny, layer.nz) < 1 or not 0 < layer.near < layer.far < np.inf:
        raise InputError("voxels: counts must be positive, and 0 < near < far")
    if layer.nx * layer.ny * layer.nz > MOST_VOXELS:
        raise InputError(f"voxels: {layer.nx} x {layer.ny} x {layer.nz} are more than {MOST_VOXELS} (1.6 GB)")
    grid = GazeGrid(layer.nx, layer.ny, layer.half_angle, layer.half_angle)
    field = trace(request.lens, request.wearer, grid)
    _some_ray_passes(field)
    depth = _ndc_planes(layer, request.wearer.eye.centre_of_rotation)
    blur = blur_on_planes(field, request.wearer.corneal_apex + depth, layer.accommodation)
    if layer.exaggeration != 1:
        blur *= np.float32(layer.exaggeration)
    shape = 2, 2, *field.shape, depth.size
    ndc = (
        ndc_blur(field, request.wearer.corneal_apex + depth, blur, layer.half_angle).reshape(shape)
        if layer.ndc
        else None
    )
    u, v = grid.axes()
    return VoxelField(layer, u, v, depth, blur.reshape(shape), field.status.reshape(field.shape), ndc)


def _ndc_planes(layer: VoxelLayer, camera: float) -> Floats:
    """Depths (nz,) mm from the cornea, equally spaced in the NDC depth of a camera so many mm behind it."""
    near, far = layer.near + camera, layer.far + camera
    return near * far / (far - np.linspace(0.0, 1.0, layer.nz) * (far - near)) - camera


@_answer.register
def seen_scene(layer: ViewLayer, request: Request) -> SeenScene:
    """The scene, and how the turning eye sees it."""
    scene = _needed_scene(request)
    lens = _needed_lens(request) if layer.through_lens else None
    if lens is not None:
        _some_ray_passes(trace(lens, request.wearer, GazeGrid()))
    return seen.seen_scene(lens, request.wearer, scene, layer)


@_answer.register
def defocus_view(layer: DefocusLayer, request: Request) -> DefocusView:
    """The defocus map in a view."""
    return seen.defocus_view(seen_scene(layer.view, request), layer.measure)


@_answer.register
def probe(layer: ProbeLayer, request: Request) -> Probe:
    """Readings along the gaze through a lens point, or in a direction."""
    lens, wearer = _needed_lens(request), request.wearer
    if layer.point is not None:
        field = look_through(lens, wearer, [layer.point[0]], [layer.point[1]])
    else:
        field = trace(lens, wearer, np.array([layer.direction], dtype=float))
    if field.status[0] != Status.OK:
        return read_probe(field, np.nan, 0.0)
    distance = _object_distance(layer.distance, _turned(field, layer), request)
    found = read_probe(field, distance, layer.accommodation)
    if not layer.quantity:
        return found
    return replace(found, value=float(_quantity(layer.quantity).values(field, distance, layer.accommodation)[0]))


def _turned(field: GazeField, layer: ProbeLayer) -> GazeField:
    """The rays of a field in the scene before which the head is turned."""
    head, centre = rotation_xy(-layer.head_tilt, layer.head_turn), field.wearer.centre_of_rotation
    return replace(field, origin=(field.origin - centre) @ head.T + centre, direction=field.direction @ head.T)
