"""The simulated view before it is drawn: how the turning eye sees the scene's points, the lens's edge, and the defocus."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .layers import EYES, MEASURES, DefocusView, SeenPart, SeenScene, ViewLayer
from .optics.atlas import BEYOND, FieldAtlas, field_atlas
from .optics.conventions import Floats, Status, listing_frame, rotation_xy
from .optics.eye import Eye, Wear, Wearer
from .optics.field import GazeField, ellipse_diagonal
from .optics.gaze import direction_from_angles, look_at, trace
from .optics.lens import Lens
from .optics.lens_edge import LensEdge, lens_edge
from .scenes.scene import Part, Scene

SAMPLES = 256  # gazes along the longer side of a lens's atlas: 0.05 pixels of 1280 over 50 degrees
NAKED_SAMPLES = 64
WIDEST = float(np.tan(np.radians(70)))


def seen_scene(lens: Lens | None, wearer: Wearer, scene: Scene, layer: ViewLayer) -> SeenScene:
    """A scene as it stands before this eye, and how the eye sees it. Raises InputError for an eye that is none of EYES."""
    if layer.eye not in EYES:
        raise InputError(f"eye: {layer.eye!r} is none of {', '.join(EYES)}")
    head = rotation_xy(-layer.head_tilt, layer.head_turn)
    frame = listing_frame(direction_from_angles(layer.azimuth, layer.elevation))
    naked = _naked_atlas(*_geometry(wearer))
    place = layer, lens, wearer, scene, wearer.centre_of_rotation, frame, head
    if lens is None:
        return SeenScene(*place, naked, None, None)
    atlas, edge = _lens_atlas(lens, *_geometry(wearer))
    return SeenScene(*place, atlas, naked, edge)


def _geometry(wearer: Wearer) -> tuple[Wear, float, float]:
    """What of a wearer decides which way the rays go: position of wear, centre of rotation and entrance pupil."""
    return wearer.wear, wearer.eye.centre_of_rotation, wearer.eye.entrance_pupil


def _wearer_of(wear: Wear, centre_of_rotation: float, entrance_pupil: float) -> Wearer:
    return Wearer(Eye(centre_of_rotation=centre_of_rotation, entrance_pupil=entrance_pupil), wear)


@lru_cache(maxsize=8)
def _naked_atlas(*geometry: Wear | float) -> FieldAtlas:
    return field_atlas(None, _wearer_of(*geometry), (-WIDEST, WIDEST, -WIDEST, WIDEST), NAKED_SAMPLES)  # type: ignore[arg-type]


@lru_cache(maxsize=8)
def _lens_atlas(lens: Lens, *geometry: Wear | float) -> tuple[FieldAtlas, LensEdge]:
    """The atlas of a worn lens over the box of its edge, a little widened, and the edge."""
    wearer = _wearer_of(*geometry)  # type: ignore[arg-type]
    edge = lens_edge(lens, wearer)
    directions = edge.directions(BEYOND)
    tangents = directions[:, :2] / np.maximum(directions[:, 2:], 0.1)
    (u0, v0), (u1, v1) = np.clip([tangents.min(axis=0), tangents.max(axis=0)], -WIDEST, WIDEST)
    return field_atlas(lens, wearer, (u0, u1, v0, v1), SAMPLES, edge), edge


# ---- vertices one by one ----------------------------------------------------------------------------------------------


def seen_parts(seen: SeenScene, lens: Lens | None) -> tuple[SeenPart, ...]:
    """Every part as seen through the lens (None: by the naked eye), each vertex by its own chief ray: exact, but slower than
    the atlas."""
    return tuple(_seen_part(seen, lens, part) for part in seen.scene.drawn)


def parts_by_zone(seen: SeenScene) -> tuple[tuple[SeenPart, ...], tuple[SeenPart, ...]]:
    """Every part as seen through the lens, and beside it by the naked eye; without a lens by the naked eye, and none."""
    return seen_parts(seen, seen.lens), () if seen.around is None else seen_parts(seen, None)


def _seen_part(seen: SeenScene, lens: Lens | None, part: Part) -> SeenPart:
    field, points = _vertex_field(lens, *_geometry(seen.wearer), part, seen.layer.head_turn, seen.layer.head_tilt)
    field = replace(field, wearer=seen.wearer)
    distance = np.where(field.status == Status.OK, field.distances_to(points), np.nan)
    blur = field.apparent_blur(distance, seen.layer.accommodation)
    gaze = np.where((field.status == Status.OK)[:, None], field.directions, np.nan)
    return SeenPart(part, gaze, -np.swapaxes(field.gaze_frame[:, :2], 1, 2) @ blur)


@lru_cache(maxsize=128)
def _vertex_field(
    lens: Lens | None, wear: Wear, centre: float, pupil: float, part: Part, turn: float, tilt: float
) -> tuple[GazeField, Floats]:
    """The gazes that meet a part's vertices, and these (n, 3) in the wear frame of the turned head.

    Kept for other looks at the part, for other eyes behind the same lens.
    """
    wearer = _wearer_of(wear, centre, pupil)
    points = (part.points - wearer.centre_of_rotation) @ rotation_xy(-tilt, turn) + wearer.centre_of_rotation
    return look_at(lens, wearer, points, within_outline=False), points


# ---- the defocus map --------------------------------------------------------------------------------------------------


def pixel_directions(layer: ViewLayer) -> Floats:
    """Directions (h, w, 3) to the pixels' centres in the picture's own frame (right-to-left, up, ahead), not normalised."""
    width, height = layer.size
    per_pixel = 2 * np.tan(layer.half_width) / width
    x = per_pixel * (width / 2 - 0.5 - np.arange(width))
    y = per_pixel * (height / 2 - 0.5 - np.arange(height))
    return np.stack([*np.meshgrid(x, y), np.ones((height, width))], axis=-1)


def right_half(width: int) -> NDArray[np.bool_]:
    """The columns (width,) of a split picture through the lens: those whose middle does not lie left of the picture's."""
    return np.arange(width) + 0.5 >= width / 2


def defocus_view(seen: SeenScene, measure: str = "defocus") -> DefocusView:
    """The blur in each pixel of a view: of the first point of the scene that its chief ray meets.

    measure: "defocus", GazeField.defocus; "ellipse_diagonal", that of Kakimoto, Tatsukawa & Nishita 2010, section 5.3, as
    the angle in which it appears from the lens. Raises InputError for another one.
    """
    if measure not in MEASURES:
        raise InputError(f"measure: {measure!r} is none of {', '.join(MEASURES)}")
    width, height = seen.layer.size
    gaze = pixel_directions(seen.layer).reshape(-1, 3) @ seen.frame @ seen.head
    values = np.full(width * height, np.nan)
    inside = np.ones(len(gaze), dtype=bool) if seen.edge is None else seen.edge.within(gaze)
    if seen.layer.split:
        inside &= np.tile(right_half(width), height)
    if inside.any():
        field, _, distance = _met(seen, gaze[inside])
        met = np.isfinite(distance)
        there = np.where(met, distance, 1e6), seen.layer.accommodation
        blur = field.defocus(*there) if measure == "defocus" else ellipse_diagonal(field.angular_blur(*there))
        values[inside] = np.where(met, blur, np.nan)
    return DefocusView(seen.layer, values.reshape(height, width), measure)


def middle_distance(seen: SeenScene) -> float:
    """Distance (mm) from the cornea of the eye looking straight ahead to what the picture's middle shows; NaN for nothing."""
    _, point, distance = _met(seen, seen.frame[2:] @ seen.head)
    apex = np.array([0.0, 0.0, seen.wearer.corneal_apex])
    return float(np.linalg.norm(point[0] - apex)) if np.isfinite(distance[0]) else np.nan


def _met(seen: SeenScene, gaze: Floats) -> tuple[GazeField, Floats, Floats]:
    """Chief rays of gazes (n, 3) in the head's frame; the points (n, 3) of the scene that they meet first, and how far (n,)."""
    from .scenes.cast import first_hit

    field = trace(seen.lens, seen.wearer, gaze)
    start, ray = (field.origin - seen.eye) @ seen.head.T + seen.eye, field.direction @ seen.head.T
    distance = first_hit(seen.scene, start, ray)
    return field, start + np.where(np.isfinite(distance), distance, np.nan)[:, None] * ray, distance
