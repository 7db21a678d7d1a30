"""make bench: measured speed; prints a table and writes reports/bench.json."""

import sys

import numba

from lensbench.output import to_json, write_file

from .files import reading_points
from .latency import map_latency
from .rays import rays_against_batoid
from .report import report_split
from .timing import ROOT
from .view import view_against_real_rays, view_cost

PARTS = (rays_against_batoid, map_latency, reading_points, report_split, view_cost, view_against_real_rays)


def main() -> int:
    """Measure, print a table, write reports/bench.json."""
    found: dict[str, float] = {"threads": float(numba.get_num_threads())}
    for part in PARTS:
        measured = part()
        found |= measured
        for name, value in measured.items():
            print(f"{name:<48} {value:10.2f}", flush=True)
    write_file(ROOT / "reports" / "bench.json", to_json(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
