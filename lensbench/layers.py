"""What can be asked of the workbench, and what it answers: frozen layers, requests and results; plain data, no computing."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .formats.power_map import PowerMap
from .optics.atlas import FieldAtlas
from .optics.conoid import GazeConoids
from .optics.conventions import Floats, ReadOnlyArrays
from .optics.eye import Wearer
from .optics.field import Accommodation
from .optics.lens import Lens
from .optics.lens_edge import LensEdge
from .optics.tolerances import Tolerances, Verification
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
    """Focimeter readings against the verification power or the order: see optics.tolerances.

    tolerances: the table; None: the package's newest edition of ANSI Z80.1.
    """

    tolerances: Tolerances | None = None


@dataclass(frozen=True, slots=True)
class RealRaysLayer:
    """First order against real rays through the whole pupil, for objects at `distances` (as in MapLayer).

    samples: along the longer side of the lens.
    """

    distances: tuple[float | str, ...] = (np.inf, 780.0, 400.0)
    samples: int = 31
    accommodation: Accommodation = "retina"


@dataclass(frozen=True, slots=True)
class DistortionLayer:
    """A flat chart of `lines` upright lines each way, straight ahead, `depth` mm before the cornea (inf: far away), up to
    half_angle (rad) from straight ahead at the centre of rotation; `fineness` points from line to line.
    """

    depth: float = np.inf
    lines: int = 13
    half_angle: float = float(np.radians(35.0))
    fineness: int = 8


@dataclass(frozen=True, slots=True)
class EllipseLayer:
    """Ellipses of confusion on planes straight ahead, at depths (mm) from the cornea, on an n x n gaze grid."""

    depths: tuple[float, ...] = (270.0, 780.0, 3400.0)
    n: int = 32
    half_angle: float = float(np.radians(28.0))
    accommodation: Accommodation = "retina"


@dataclass(frozen=True, slots=True)
class ConoidLayer:
    """The spread of light along one gaze (azimuth, elevation: rad), for an object at `distance` as in MapLayer."""

    azimuth: float = 0.0
    elevation: float = 0.0
    distance: float | str = 400.0
    accommodation: Accommodation = "retina"


@dataclass(frozen=True, slots=True)
class VoxelLayer:
    """Blur matrices in the voxels of a view frustum: nx x ny gazes, nz planes equally spaced in NDC depth.

    near, far: depths, mm from the cornea. half_angle: at the centre of rotation, rad. exaggeration: of all matrices. ndc:
    also in the picture's own units. Kakimoto, Tatsukawa & Nishita 2010.
    """

    nx: int
    ny: int
    nz: int
    near: float = 200.0
    far: float = 10000.0
    half_angle: float = float(np.radians(28.0))
    accommodation: Accommodation = "retina"
    exaggeration: float = 1.0
    ndc: bool = False


@dataclass(frozen=True, slots=True)
class ViewLayer:
    """What the turning eye sees of the scene. eye: one of EYES; "pinhole": through the lens, nothing blurred; "perfect":
    without the lens, nothing blurred.

    azimuth, elevation: direction of the picture's centre in the scene, rad. half_width: rad. size: pixels (width, height).
    head_turn, head_tilt: head and lens turned towards the wearer's left and upwards, rad, about the eye's centre of
    rotation, which stays where it is: the eye counter-rotates, and sees the same of the scene through another part of the
    lens. split: the picture's left half as without the lens.
    """

    eye: str = "lens"
    azimuth: float = 0.0
    elevation: float = 0.0
    half_width: float = float(np.radians(25.0))
    size: tuple[int, int] = (640, 480)
    accommodation: Accommodation = "retina"
    head_turn: float = 0.0
    head_tilt: float = 0.0
    split: bool = False

    @property
    def sharp(self) -> bool:
        """Whether nothing is blurred."""
        return self.eye in ("pinhole", "perfect")

    @property
    def through_lens(self) -> bool:
        """Whether the eye looks through the lens."""
        return self.eye in ("lens", "pinhole")


@dataclass(frozen=True, slots=True)
class DefocusLayer:
    """Defocus map of a view: the blur of what the eye meets in each pixel of the view. measure: one of MEASURES."""

    view: ViewLayer = ViewLayer()
    measure: str = "defocus"


@dataclass(frozen=True, slots=True, eq=False)
class AgainstLayer:
    """The lens against a measured map of it. by: "lensmeter" (back vertex power) or "worn", for objects at `distance` mm."""

    measured: PowerMap
    by: str = "lensmeter"
    distance: float = np.inf


@dataclass(frozen=True, slots=True)
class ProbeLayer:
    """Readings along one gaze: through a point (x, y) mm of the front surface, or in a direction (3,) of the wear frame.

    distance: as in MapLayer. head_turn, head_tilt: as in ViewLayer, for what is met in the scene. quantity: of a map, to be
    read there too.
    """

    point: tuple[float, float] | None = None
    direction: tuple[float, float, float] | None = None
    distance: float | str = np.inf
    accommodation: Accommodation = "retina"
    head_turn: float = 0.0
    head_tilt: float = 0.0
    quantity: str = ""


MEASURES = ("defocus", "ellipse_diagonal")  # as the quantities of a map
EYES = ("lens", "naked", "pinhole", "perfect")
Layer = (
    MapLayer
    | ProfileLayer
    | PointsLayer
    | VerificationLayer
    | RealRaysLayer
    | DistortionLayer
    | EllipseLayer
    | ConoidLayer
    | VoxelLayer
    | ViewLayer
    | DefocusLayer
    | AgainstLayer
    | ProbeLayer
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

    @property
    def column(self) -> str:
        """The quantity with its unit, as tables and meshes name its values."""
        return f"{self.quantity}_{self.unit}"


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
    magnitude of the difference of the focimeter's to the prism that it should read, cm/m; each None where nothing is ordered.
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
    """Blur of n gazes for objects at `distance`: rms diameter on the retina, arcmin, to the first order and by
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
class DistortionGrid(ReadOnlyArrays):
    """A chart and its image. object, apparent (n, n, 2): tangents of the true and of the seen direction of its points, x
    towards the wearer's left and y up, from the centre of rotation; rows run upwards. status (n, n). The lines of the
    chart are every layer.fineness-th row and column.
    """

    layer: DistortionLayer
    object: Floats
    apparent: Floats
    status: NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False)
class Probe(ReadOnlyArrays):
    """A gaze and what is read along it. point: (x, y) mm on the front surface. direction (3,): of the gaze; azimuth,
    elevation: degrees. exit (3,) mm, outgoing (3,): the ray in the scene; all in the wear frame.

    distance: of the object along it, mm. sphere, cylinder, mean_power (D), axis (degrees): as worn for that distance. prism
    (cm/m), prism_base (degrees). semi_major, semi_minor: of the ellipse of confusion there, mm; NaN at infinity.
    accommodation: in use, D. defocus: rms blur diameter, arcmin. status: of the ray; readings are NaN where it is not OK.
    value: of the quantity that was asked for, in its unit.
    """

    point: tuple[float, float]
    direction: Floats
    azimuth: float
    elevation: float
    exit: Floats
    outgoing: Floats
    distance: float
    sphere: float
    cylinder: float
    axis: float
    mean_power: float
    prism: float
    prism_base: float
    semi_major: float
    semi_minor: float
    accommodation: float
    defocus: float
    status: int
    value: float = float("nan")


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
    tangents of the gaze; depth (nz,): mm from the cornea; status (ny, nx). NaN where a ray failed or the
    plane lies behind the lens. ndc: the same as blur, in NDC units of the picture of the turning eye (x to the wearer's
    left, y up, 2 from side to side); None where not asked for.
    """

    layer: VoxelLayer
    u: Floats
    v: Floats
    depth: Floats
    blur: NDArray[np.float32]
    status: NDArray[np.int8]
    ndc: NDArray[np.float32] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SeenScene(ReadOnlyArrays):
    """Everything a renderer needs: the scene as it stands before this eye, and how the eye sees it.

    eye (3,): centre of rotation, where the camera stands, mm. frame (3, 3): rows right-to-left, up and ahead of the
    picture. head (3, 3): wear frame of the turned head to the scene's frame. through: the field of the lens (or of the
    naked eye). around, edge: the naked eye's field, seen beyond the lens's edge; None without a lens.
    """

    layer: ViewLayer
    lens: Lens | None
    wearer: Wearer
    scene: Scene
    eye: Floats
    frame: Floats
    head: Floats
    through: FieldAtlas
    around: FieldAtlas | None
    edge: LensEdge | None


@dataclass(frozen=True, slots=True, eq=False)
class SeenPart(ReadOnlyArrays):
    """The vertices of a part as the eye sees them. gaze (n, 3): apparent unit directions, wear frame.

    spread (n, 3, 2): change of the (not normalised) direction by the pupil's unit vectors; the point appears all over
    gaze + spread @ d with d in the unit disc. Vertices that no ray meets hold NaN.
    """

    part: Part
    gaze: Floats
    spread: Floats


@dataclass(frozen=True, slots=True, eq=False)
class DefocusView(ReadOnlyArrays):
    """defocus (h, w), rad, first row at the top: the blur in each pixel of a view by a measure of MEASURES.

    NaN beyond the lens's edge, where no ray passes, and where the scene is empty.
    """

    layer: ViewLayer
    defocus: Floats
    measure: str = "defocus"


@dataclass(frozen=True, slots=True, eq=False)
class Deviation(ReadOnlyArrays):
    """Measured less designed power at map points x (nx,), y (ny,) mm: mean (ny, nx), D; astigmatic (ny, nx): magnitude of the
    astigmatic difference, D; NaN where nothing was measured or status (ny, nx) is not OK.
    """

    layer: AgainstLayer
    x: Floats
    y: Floats
    mean: Floats
    astigmatic: Floats
    status: NDArray[np.int8]


Result = (
    LensMap
    | Profile
    | tuple[PointReading, ...]
    | Verification
    | None
    | RealRays
    | DistortionGrid
    | tuple[EllipseSheet, ...]
    | GazeConoids
    | VoxelField
    | SeenScene
    | DefocusView
    | Deviation
)
