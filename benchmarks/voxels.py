"""The blur field of a view frustum: the paper's two schemes and ours, at the sizes of its Table 3."""

from collections.abc import Callable
from functools import partial

import numba as nb
import numpy as np

import lensbench as lb
from lensbench.optics.field import GazeField
from lensbench.optics.lens import Lens
from lensbench.optics.voxels import blur_on_planes

from . import kakimoto
from .figures import Figure
from .timing import ROOT, rounds

SIZES = ((32, 64), (32, 128), (32, 256), (64, 128), (64, 256))
MODELS = {"toric": "toric_R", "progressive": "regular_R"}
HALF_ANGLE = float(np.radians(28.0))


def blur_fields() -> list[Figure]:
    """Table 1, Table 2 and ours on two lenses, the targets at the largest size; and ours against a plain fill of memory."""
    wearer = lb.load_wearer(ROOT / "sample_lenses" / "young_astigmat.toml")
    figures = []
    for model, name in MODELS.items():
        lens = lb.load_lens(ROOT / "sample_lenses" / f"{name}.toml")
        for n, planes in SIZES:
            figures += _compared(model, Job(lens, wearer, n, planes), largest=(n, planes) == SIZES[-1])
    return figures + _against_a_fill(Job(lens, wearer, *SIZES[-1]))


class Job:
    """A lens, a wearer and a frustum of n x n gazes and so many planes, equally spaced in vergence from 20 cm to 10 m."""

    def __init__(self, lens: Lens, wearer: lb.Wearer, n: int, planes: int) -> None:
        self.lens, self.wearer, self.size = lens, wearer, f"{n} x {n} x {planes}"
        self.grid = lb.GazeGrid(n, n, HALF_ANGLE, HALF_ANGLE)
        self.z = wearer.centre_of_rotation[2] + 1 / np.linspace(1 / 200, 1 / 10000, planes)
        self.voxels = np.empty((2, 2, n * n, planes), dtype=np.float32)
        self.rows, self.eye = kakimoto.chief_rays(self.field()), kakimoto.eye_of(wearer)
        self.columns = np.empty((12, n * n))

    def field(self) -> GazeField:
        """Ours: the gaze field, from which any voxel follows."""
        return lb.trace(self.lens, self.wearer, self.grid)

    def written(self) -> None:
        """Ours, with every voxel written."""
        blur_on_planes(self.field(), self.z, out=self.voxels)

    def table_1(self) -> None:
        """The paper's Table 1: every step for every voxel."""
        out = self.voxels.reshape(4, self.z.size, -1)
        kakimoto.previous(self.rows, self.lens.index, self.eye, self.z, None, out)

    def table_2(self) -> None:
        """The paper's Table 2: the conoid of each ray, then eq. 10 and 12 for every voxel."""
        kakimoto.conoid_rays(self.rows, self.lens.index, self.eye, (None, kakimoto.PROJECTED), self.columns)
        kakimoto.conoid_voxels(self.columns, self.z, self.voxels.reshape(4, self.z.size, -1))

    def table_1_tuned(self) -> None:
        """Table 1 by roots for angles, and ray by ray, so that what does not depend on the depth is done once."""
        out = self.voxels.reshape(4, -1, self.z.size)
        kakimoto.previous_by_ray(self.rows, self.lens.index, self.eye, self.z, True, out)

    def table_2_tuned(self) -> None:
        """Table 2 by roots for angles, ray by ray, and the voxels in single precision."""
        kakimoto.conoid_rays(self.rows, self.lens.index, self.eye, (True, kakimoto.PROJECTED), self.columns)
        columns, z = self.columns.astype(np.float32), self.z.astype(np.float32)
        kakimoto.conoid_voxels_by_ray(columns, z, self.voxels.reshape(4, -1, z.size))


def _compared(model: str, job: Job, largest: bool) -> list[Figure]:
    def at_least(target: float) -> float | None:
        return target if largest else None

    actions: list[Callable[[], object]] = [job.table_1, job.table_2, job.field, job.written]
    first, second, field, written, *tuned = rounds(
        *actions, *([job.table_1_tuned, job.table_2_tuned] if largest else [])
    )
    about = f"{model}, {job.size}"
    figures = [
        Figure(f"{about}: Table 1", first * 1e3, "ms"),
        Figure(f"{about}: Table 2", second * 1e3, "ms"),
        Figure(f"{about}: ours, the field", field * 1e3, "ms"),
        Figure(f"{about}: ours, every voxel written", written * 1e3, "ms"),
        Figure(f"{about}: Table 1 / field", first / field, "x", at_least(300)),
        Figure(f"{about}: Table 2 / field", second / field, "x", at_least(20)),
        Figure(f"{about}: Table 1 / written", first / written, "x", at_least(20)),
        Figure(f"{about}: Table 2 / written", second / written, "x", at_least(1.3)),
    ]
    names = "tuned Table 1 (roots, ray by ray)", "tuned Table 2 (roots, ray by ray, float32)"
    for name, seconds in zip(names, tuned, strict=False):
        figures.append(Figure(f"{about}: {name}", seconds * 1e3, "ms"))
        figures.append(Figure(f"{about}: {name} / written", seconds / written, "x"))
    return figures


@nb.njit(nogil=True, cache=True, parallel=True)
def fill(out: np.ndarray, value: np.float32) -> None:
    """A plain fill of memory on the same threads."""
    for i in nb.prange(out.size):
        out[i] = value


def _against_a_fill(job: Job) -> list[Figure]:
    field, flat = job.field(), job.voxels.reshape(-1)
    evaluated, filled = rounds(
        partial(blur_on_planes, field, job.z, out=job.voxels), partial(fill, flat, np.float32(1)), count=31
    )
    return [
        Figure(f"{job.size} voxels from a field that is there", evaluated * 1e3, "ms"),
        Figure(f"{flat.nbytes / 1e6:.1f} MB filled", filled * 1e3, "ms"),
        Figure(f"{job.size} voxels / the same bytes filled", evaluated / filled, "x", at_most=4),
    ]
