"""What can be asked of the workbench, and what it answers: frozen layers, requests and results; plain data, no computing."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .optics.conventions import Floats, ReadOnlyArrays
from .optics.eye import Wearer
from .optics.field import Accommodation
from .optics.lens import Lens
from .optics.tolerances import ToleranceLine
from .scenes.scene import Part, Scene

# ---- layers: what can be asked for ----


@dataclass(frozen=True, slots=True)
class MapLayer:
    """A quantity over the front surface.

    distance: mm from the front surface, inf, "scene" (first hit of each ray) or "model" (the wearer's object distances by
    lowering of the gaze, see optics.object_distance).
    """

    quantity: str
    distance: float | str = np.inf
    accommodation: Accommodation = "retina"
    samples: int = 121


@dataclass(frozen=True, slots=True)
class ProfileLayer:
    """As-worn power along the lens's main meridian, for objects at `distance` as in MapLayer."""

    distance: float | str = np.inf
    samples: int = 121


@dataclass(frozen=True, slots=True)
class PointsLayer:
    """Power at the reference points, by focimeter and as worn; as worn the near reference point is read at the wearer's
    near distance from the cornea.
    """


@dataclass(frozen=True, slots=True)
class VerificationLayer:
    """Focimeter readings against the order with tolerances: see optics.tolerances."""


@dataclass(frozen=True, slots=True)
class RealRaysLayer:
    """First order against real rays through the whole pupil, for objects at `distances` (as in MapLayer).

    samples: along the longer side of the lens.
    """

    distances: tuple[float | str, ...] = (np.inf, 780.0, 400.0)
    samples: int = 31
    accommodation: Accommodation = "retina"


@dataclass(frozen=True, slots=True)
class EllipseLayer:
    """Ellipses of confusion on planes straight ahead, at depths (mm) from the back vertex, on an n x n gaze grid."""

    depths: tuple[float, ...] = (270.0, 780.0, 3400.0)
    n: int = 32
    half_angle: float = float(np.radians(28.0))
    accommodation: Accommodation = "retina"


@dataclass(frozen=True, slots=True)
class VoxelLayer:
    """Blur matrices in the voxels of a view frustum: nx x ny gazes, nz planes equally spaced in NDC depth.

    near, far: mm ahead of the centre of rotation. half_angle: rad. Kakimoto, Tatsukawa & Nishita 2010.
    """

    nx: int
    ny: int
    nz: int
    near: float = 200.0
    far: float = 10000.0
    half_angle: float = float(np.radians(28.0))
    accommodation: Accommodation = "retina"


@dataclass(frozen=True, slots=True)
class ViewLayer:
    """What the turning eye sees of the scene. eye: "lens", "naked", or "pinhole" (through the lens, nothing blurred).

    azimuth, elevation: gaze at the picture's centre, rad. half_width: rad. size: pixels (width, height).
    """

    eye: str = "lens"
    azimuth: float = 0.0
    elevation: float = 0.0
    half_width: float = float(np.radians(25.0))
    size: tuple[int, int] = (640, 480)
    accommodation: Accommodation = "retina"


Layer = (
    MapLayer | ProfileLayer | PointsLayer | VerificationLayer | RealRaysLayer | EllipseLayer | VoxelLayer | ViewLayer
)


@dataclass(frozen=True, slots=True, eq=False)
class Request:
    """One question to the optics. lens None: the naked eye (views and ellipses only). scene: for what needs one.

    A scene is centred on the face's midline; the lens's side and the pupillary distance say where the eye is.
    """

    lens: Lens | None
    wearer: Wearer
    layer: Layer
    scene: Scene | None = None


# ---- results ----


@dataclass(frozen=True, slots=True, eq=False)
class LensMap(ReadOnlyArrays):
    """values, status (ny, nx) of a quantity at lens points x (nx,), y (ny,) mm on the front surface; NaN where not OK."""

    quantity: str
    label: str
    unit: str
    x: Floats
    y: Floats
    values: Floats
    status: NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False)
class Profile(ReadOnlyArrays):
    """Power along the meridian: lens points x, y (n,) mm; mean, least and greatest as-worn power and astigmatism (n,) D."""

    x: Floats
    y: Floats
    mean_power: Floats
    least_power: Floats
    greatest_power: Floats
    astigmatism: Floats


@dataclass(frozen=True, slots=True)
class PointReading:
    """As-worn and focimeter reading at a reference point. Lens point mm, gaze degrees, powers D, prism cm/m, axis and base
    degrees.

    mean_error, astigmatic_error: as-worn less ordered power (mean; magnitude of the astigmatic difference), D; prism_error:
    magnitude of the difference of the focimeter's to the ordered prism, cm/m; each None where nothing is ordered.
    lensmeter_...: back vertex power and prism along the back normal, see optics.lensmeter.
    """

    name: str
    x: float
    y: float
    azimuth: float
    elevation: float
    distance: float
    sphere: float
    cylinder: float
    axis: float
    mean_power: float
    astigmatism: float
    prism: float
    prism_base: float
    mean_error: float | None
    astigmatic_error: float | None
    prism_error: float | None
    lensmeter_sphere: float
    lensmeter_cylinder: float
    lensmeter_axis: float
    lensmeter_prism: float
    lensmeter_prism_base: float
    status: str


@dataclass(frozen=True, slots=True, eq=False)
class RealRaysCheck(ReadOnlyArrays):
    """Blur of n gazes for objects at `distance`: angular diameter 2|eps| on the retina, arcmin, to the first order and by
    the second moments of real rays through the whole pupil; higher_order_rms (n,): of the wave aberration, um.
    """

    distance: float | str
    first_order: Floats
    real_rays: Floats
    higher_order_rms: Floats

    @property
    def deviation(self) -> Floats:
        """First order less real rays (n,), arcmin."""
        return self.first_order - self.real_rays


@dataclass(frozen=True, slots=True, eq=False)
class Spot(ReadOnlyArrays):
    """Real rays of one gaze at objects `distance` mm away. points (m, 2): landing points about the chief ray, arcmin, along
    e1 (wearer's left) and e2 (up); first_order (2, 2): matrix of the first-order ellipse of confusion, arcmin.
    """

    name: str
    distance: float
    points: Floats
    first_order: Floats


@dataclass(frozen=True, slots=True, eq=False)
class RealRays:
    """What the first order leaves out: one check a distance, and spots at chosen gazes."""

    checks: tuple[RealRaysCheck, ...]
    spots: tuple[Spot, ...]


@dataclass(frozen=True, slots=True, eq=False)
class EllipseSheet(ReadOnlyArrays):
    """Ellipses on one plane at `depth` mm. centre (n, 3) mm; spokes (n, 3, 2): images of the pupil's unit vectors, mm.

    semi_major, semi_minor (n,) mm; orientation (n,) rad; accommodation (n,) D; status (n,).
    """

    depth: float
    centre: Floats
    spokes: Floats
    semi_major: Floats
    semi_minor: Floats
    orientation: Floats
    accommodation: Floats
    status: NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False)
class VoxelField(ReadOnlyArrays):
    """blur (2, 2, ny, nx, nz) float32: four planes M11, M12, M21, M22, mm across the outgoing rays; u (nx,), v (ny,):
    tangents of the gaze; depth (nz,): mm ahead of the centre of rotation; status (ny, nx). NaN where a ray failed or the
    plane lies behind the lens.
    """

    u: Floats
    v: Floats
    depth: Floats
    blur: NDArray[np.float32]
    status: NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False)
class SeenPart(ReadOnlyArrays):
    """A part as the eye sees it. gaze (n, 3): apparent unit directions, wear frame; reach (n,): true distance, mm.

    spread (n, 3, 2): change of the (not normalised) direction by the pupil's unit vectors; the point appears all over
    gaze + spread @ d with d in the unit disc. Vertices that no ray meets hold NaN.
    """

    part: Part
    gaze: Floats
    reach: Floats
    spread: Floats


@dataclass(frozen=True, slots=True, eq=False)
class SeenScene(ReadOnlyArrays):
    """Everything a renderer needs: the camera stands at `eye` (3,) mm and its rows of `frame` (3, 3) are right-to-left,
    up and ahead. through: parts seen through the lens (or by the naked eye); around: parts as seen past the lens's edge,
    None for the naked eye. rims: closed curves (k, 2) in the picture plane (tangents along frame rows 0 and 1) within all
    of which the lens is seen.
    """

    layer: ViewLayer
    background: tuple[int, int, int]
    eye: Floats
    frame: Floats
    through: tuple[SeenPart, ...]
    around: tuple[SeenPart, ...] | None
    rims: tuple[Floats, ...]


Result = (
    LensMap
    | Profile
    | tuple[PointReading, ...]
    | tuple[ToleranceLine, ...]
    | RealRays
    | tuple[EllipseSheet, ...]
    | VoxelField
    | SeenScene
)
