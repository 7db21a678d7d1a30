"""The ellipses of confusion on a plane by the paper's two schemes, by the gaze field, and by real rays."""

from dataclasses import replace

import numpy as np

import lensbench as lb
from lensbench.optics import surfaces
from lensbench.optics.conventions import Floats, Status, listing_frame, power_matrix
from lensbench.optics.field import GazeField, ellipse
from lensbench.optics.gaze import trace_rays

from . import kakimoto
from .timing import ROOT


def cases() -> dict[str, tuple[lb.Lens, lb.Wearer]]:
    """Lenses with eyes that do not accommodate, so that all three mean the same ellipse."""
    samples = ROOT / "sample_lenses"
    regular, toric = (lb.load_lens(samples / f"{name}.toml") for name in ("regular_R", "toric_R"))
    wearer = lb.load_wearer(samples / "presbyope_60.toml")
    strong = replace(toric, front=surfaces.sphere(300.0), back=surfaces.toric(1 / 75, 1 / 53, 20.0))

    def seen_by(*refraction: float) -> lb.Wearer:
        return replace(wearer, eye=lb.Eye(power_matrix(*refraction), pupil_diameter=4.0))

    return {
        "progressive, emmetrope": (regular, seen_by(0.0)),
        "progressive, -0.50 -0.75 x 30": (regular, seen_by(-0.5, -0.75, 30.0)),
        "toric -2.00 -1.50 x 20, its eye": (toric, seen_by(-2.0, -1.5, 20.0)),
        "toric -6 -3.5 x 20, eye -6.00 -3.50 x 35": (strong, seen_by(-6.0, -3.5, 35.0)),
    }


def passing_field(lens: lb.Lens, wearer: lb.Wearer, grid: lb.GazeGrid) -> GazeField:
    """The field of those rays of a grid that pass the lens."""
    field = lb.trace(lens, wearer, grid)
    return lb.trace(lens, wearer, field.directions[field.status == Status.OK])


def sizes(matrices: Floats) -> tuple[Floats, Floats]:
    """Rms size and semi-major axis of the ellipses of matrices (n, 2, 2)."""
    return np.sqrt(np.sum(matrices**2, axis=(1, 2)) / 2), ellipse(matrices).semi_major


def ours(field: GazeField, plane: float) -> Floats:
    """Blur matrices (n, 2, 2), mm, of the gaze field."""
    return field.blur(distance(field, plane))


def by_table_1(field: GazeField, plane: float) -> Floats:
    """Blur matrices (n, 2, 2), mm, of Table 1."""
    out = np.empty((4, 1, field.status.size))
    rows, eye = kakimoto.chief_rays(field), kakimoto.eye_of(field.wearer)
    kakimoto.previous(rows, field.lens.index, eye, np.array([plane]), None, out)
    return np.moveaxis(out.reshape(2, 2, -1), -1, 0)


def by_table_2(field: GazeField, plane: float, reading: int = kakimoto.PROJECTED) -> Floats:
    """Blur matrices (n, 2, 2), mm, of Table 2; NaN where eq. 11 has no answer."""
    columns, out = np.empty((12, field.status.size)), np.empty((4, 1, field.status.size))
    rows, eye = kakimoto.chief_rays(field), kakimoto.eye_of(field.wearer)
    kakimoto.conoid_rays(rows, field.lens.index, eye, (None, reading), columns)
    kakimoto.conoid_voxels(columns, np.array([plane]), out)
    return np.moveaxis(out.reshape(2, 2, -1), -1, 0)


def distance(field: GazeField, plane: float) -> Floats:
    """Distance along each outgoing ray to the plane, mm."""
    return (plane - field.origin[:, 2]) / field.direction[:, 2]


def real_ellipses(field: GazeField, plane: float) -> tuple[Floats, Floats]:
    """Rms size and semi-major axis (n,), mm, of the ellipse with the second moments of real rays."""
    landed = real_rays(field, plane)
    landed -= landed.mean(axis=1, keepdims=True)
    moments = np.linalg.eigvalsh(np.swapaxes(landed, 1, 2) @ landed / landed.shape[1])
    return np.sqrt(2 * moments.sum(axis=1)), 2 * np.sqrt(moments[:, 1])


def real_rays(field: GazeField, plane: float) -> Floats:
    """Where real rays (n, 128, 2), mm, 8 x 16 of equal area a pupil, meet the plane across each outgoing ray."""
    disc = np.sqrt((np.arange(8) + 0.5)[:, None] / 8) * np.exp(2j * np.pi * np.arange(16) / 16)
    disc = disc.ravel()
    eye, wearer = field.wearer.eye, field.wearer
    offset = eye.pupil_diameter / 2 * np.stack([disc.real, disc.imag], axis=1)
    across = field.gaze_frame[:, :2]
    pupil = wearer.centre_of_rotation + eye.pupil_from_rotation * field.directions
    start = pupil[:, None] + offset @ across
    aim = field.directions[:, None] + (offset @ eye.pupil_refraction / 1000) @ across
    aim /= np.linalg.norm(aim, axis=-1, keepdims=True)
    rays = trace_rays(field.lens, wearer.wear, start.reshape(-1, 3), aim.reshape(-1, 3))
    centre = field.origin + distance(field, plane)[:, None] * field.direction
    leave, along = rays.exit.reshape(*aim.shape) - centre[:, None], rays.direction.reshape(aim.shape)
    normal = field.direction[:, None]
    landed = leave - (np.sum(leave * normal, -1) / np.sum(along * normal, -1))[..., None] * along
    return landed @ np.swapaxes(listing_frame(field.direction)[:, :2], 1, 2)
