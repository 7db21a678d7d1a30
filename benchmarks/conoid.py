"""python -m benchmarks.conoid: the tables of docs/conoid.md, the paper's two schemes and ours against real rays."""

from dataclasses import replace

import numpy as np

import lensbench as lb
from lensbench.optics import surfaces
from lensbench.optics.conventions import Floats, Status, listing_frame, power_matrix
from lensbench.optics.field import GazeField, ellipse
from lensbench.optics.gaze import trace_rays
from lensbench.output import write_file

from .timing import ROOT
from .voxels import kakimoto

PAGE = ROOT / "docs" / "conoid.md"
BEGIN, END = "<!-- tables: python -m benchmarks.conoid -->", "<!-- end of tables -->"
PLANES = (270.0, 780.0, 3400.0)
GRID = lb.GazeGrid(32, 32, float(np.radians(25)), float(np.radians(25)))
HEAD = ("lens, eye", "plane", "ours", "Table 1", "Table 2", "Table 2: no answer, or off by more than half")


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


def main() -> None:
    """Measure and write the tables into the page."""
    rms, major = [], []
    for name, (lens, wearer) in cases().items():
        field = lb.trace(lens, wearer, GRID)
        field = lb.trace(lens, wearer, field.directions[field.status == Status.OK])
        for plane in PLANES:
            row = [name, f"{plane / 10:g} cm"]
            real, schemes = real_ellipses(field, plane), by_scheme(field, plane)
            for rows, k in ((rms, 0), (major, 1)):
                lost = np.mean(~(np.abs(schemes[2][k] / real[k] - 1) < 0.5))
                rows.append([*row, *(error(scheme[k], real[k]) for scheme in schemes), f"{lost:.1%}"])
    text = PAGE.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    tables = f"\n\n### Rms size\n{table(rms)}\n\n### Semi-major axis\n{table(major)}\n\n"
    write_file(PAGE, before + BEGIN + tables + END + rest.split(END)[1])


def table(rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [HEAD, ("---",) * len(HEAD), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def error(mine: Floats, real: Floats) -> str:
    """Median and 90th percentile of the relative error, where there is an answer."""
    off = np.abs(mine / real - 1)
    if not np.isfinite(off).any():
        return "-"
    return " / ".join(f"{p:.1%}" for p in np.nanpercentile(off, [50, 90]))


def sizes(matrices: Floats) -> tuple[Floats, Floats]:
    """Rms size and semi-major axis of the ellipses of matrices (n, 2, 2)."""
    return np.sqrt(np.sum(matrices**2, axis=(1, 2)) / 2), ellipse(matrices).semi_major


def by_scheme(field: GazeField, plane: float) -> list[tuple[Floats, Floats]]:
    """Sizes by the field, by Table 1 and by Table 2."""
    rows, eye, n = kakimoto.chief_rays(field), kakimoto.eye_of(field.wearer), field.status.size
    z, out, columns = np.array([plane]), np.empty((2, 4, 1, n)), np.empty((16, n))
    kakimoto.previous(rows, field.lens.index, eye, z, None, out[0])
    kakimoto.conoid_rays(rows, field.lens.index, eye, None, columns)
    kakimoto.conoid_voxels(columns, z, out[1])
    return [
        sizes(field.blur(distance(field, plane))),
        *(sizes(scheme.reshape(2, 2, n).transpose(2, 0, 1)) for scheme in out),
    ]


def distance(field: GazeField, plane: float) -> Floats:
    """Distance along each outgoing ray to the plane, mm."""
    return (plane - field.origin[:, 2]) / field.direction[:, 2]


def real_ellipses(field: GazeField, plane: float) -> tuple[Floats, Floats]:
    """Rms size and semi-major axis of the ellipse with the second moments of real rays: 8 x 16 of equal area a pupil."""
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
    local = landed @ np.swapaxes(listing_frame(field.direction)[:, :2], 1, 2)
    local -= local.mean(axis=1, keepdims=True)
    moments = np.linalg.eigvalsh(np.swapaxes(local, 1, 2) @ local / disc.size)
    return np.sqrt(2 * moments.sum(axis=1)), 2 * np.sqrt(moments[:, 1])


if __name__ == "__main__":
    main()
