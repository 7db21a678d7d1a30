"""make bench: rays per second against batoid, latency of a map after an edit, and a whole report; JSON in reports/."""

import os
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import numba
import numpy as np

import lensbench as lb
from lensbench.optics import surfaces
from lensbench.optics.conventions import mean_power, power_matrix
from lensbench.optics.gaze import trace_rays
from lensbench.optics.lens import Lens, circle_outline
from lensbench.optics.materials import MATERIALS
from lensbench.output import to_json, write_file

ROOT = Path(__file__).parent.parent


def rounds(*actions: Callable[[], Any], count: int = 7) -> list[float]:
    """Median seconds of each action, the actions taking turns after one warm-up."""
    times: list[list[float]] = [[] for _ in actions]
    for k in range(count + 1):
        for action, kept in zip(actions, times, strict=True):
            since = time.perf_counter()
            action()
            if k:
                kept.append(time.perf_counter() - since)
    return [median(kept) for kept in times]


def rays_against_batoid() -> dict[str, float]:
    """Sphere/sphere and sphere/asphere, gazes within 31 degrees: ours with the transfer matrix, batoid's bare rays."""
    n = 200_000
    rng = np.random.default_rng(1)
    gaze = np.stack([*rng.uniform(-0.6, 0.6, (2, n)), np.ones(n)], axis=1)
    gaze /= np.linalg.norm(gaze, axis=1, keepdims=True)
    start = np.array([0.0, 0.0, -27.0]) + 10.0 * gaze
    found = {}
    for name, alpha in (("sphere/sphere", 0.0), ("sphere/asphere", 2e-7)):
        front = surfaces.conic(1 / 95.0, 0.0, [alpha])
        lens = Lens(front, surfaces.sphere(110.0), 2.0, MATERIALS["MR-8"], circle_outline(70.0))
        ours, theirs = rounds(partial(trace_rays, lens, lb.Wear(), start, gaze), batoid_trace(lens, alpha, start, gaze))
        found[f"{name}: ours with transfer matrix, Mrays/s"] = n / ours / 1e6
        found[f"{name}: batoid, Mrays/s"] = n / theirs / 1e6
        found[f"{name}: ratio"] = theirs / ours
    return found


def batoid_trace(lens: Lens, alpha: float, start: np.ndarray, gaze: np.ndarray) -> Callable[[], None]:
    """The same lens and rays in batoid, ready to be traced."""
    import batoid

    front = batoid.Asphere(-95.0, 0.0, [-alpha]) if alpha else batoid.Sphere(-95.0)
    back, outer = batoid.Sphere(-110.0), batoid.CoordSys((0, 0, lens.centre_thickness))
    air, glass = batoid.ConstMedium(1.0), batoid.ConstMedium(lens.index)
    rays = batoid.RayVector(*start.T, *gaze.T)

    def trace() -> None:
        moving = rays.copy()
        back.refract(moving, air, glass)
        front.refract(moving, glass, air, coordSys=outer)

    return trace


def map_latency() -> dict[str, float]:
    """A 128 x 128 map of mean power: after a change of refraction, and after a change of the lens; ms."""
    lens = lb.load_lens(ROOT / "sample_lenses" / "regular_R.toml")
    wearer = lb.load_wearer(ROOT / "sample_lenses" / "presbyope_60.toml")
    grid = lb.GazeGrid(128, 128)
    field = lb.trace(lens, wearer, grid)
    eye = replace(wearer.eye, refraction=power_matrix(-1.0))

    def refraction() -> None:
        mean_power(field.with_eye(eye).power_error(400.0))

    def thickness() -> None:
        mean_power(lb.trace(replace(lens, centre_thickness=3.0), wearer, grid).power_error(400.0))

    algebra, traced = rounds(refraction, thickness)
    return {"map after a new refraction, ms": algebra * 1e3, "map after a new thickness, ms": traced * 1e3}


def report_split() -> dict[str, float]:
    """A whole report of the regular sample lens, warm: seconds by step."""
    from lensbench.report.build import DEFAULT_DISTANCES, build_report
    from lensbench.report.progress import Progress

    lens = lb.load_lens(ROOT / "sample_lenses" / "regular_R.toml")
    wearer = lb.load_wearer(ROOT / "sample_lenses" / "presbyope_60.toml")
    with tempfile.TemporaryDirectory() as folder, open(os.devnull, "w") as nowhere:
        build_report(lens, wearer, Path(folder), DEFAULT_DISTANCES, Progress(nowhere))
        progress = Progress(nowhere)
        build_report(lens, wearer, Path(folder), DEFAULT_DISTANCES, progress)
        progress.done()
    split = {f"report: {name}, s": seconds for name, seconds in progress.seconds.items()}
    return split | {"report: total, s": sum(progress.seconds.values())}


def main() -> int:
    """Measure, print a table, write reports/bench.json."""
    found: dict[str, float] = {"threads": float(numba.get_num_threads())}
    for part in (rays_against_batoid, map_latency, report_split):
        measured = part()
        found |= measured
        for name, value in measured.items():
            print(f"{name:<48} {value:10.2f}", flush=True)
    write_file(ROOT / "reports" / "bench.json", to_json(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
