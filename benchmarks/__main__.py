"""make bench, lensbench bench: measured speed, each figure beside its target; writes reports/bench.json and bench.html.

With names of parts (python -m benchmarks growth peak_memory) only these are measured, and no file is written.
"""

import sys

from lensbench.output import to_json, write_file

from .figures import Figure, about_machine, as_data, as_page
from .files import reading_points
from .fresh import first_calls, peak_memory
from .growth import growth
from .latency import map_latency
from .rays import rays_against_peers
from .report import report_split
from .timing import ROOT
from .view import view_against_real_rays, view_cost
from .voxels import blur_fields
from .window import window_latency

# A part measures and returns its figures, or a dict of plain ones by name; add yours here.
PARTS = (
    blur_fields, growth, map_latency, rays_against_peers, peak_memory, first_calls, reading_points, report_split,
    view_cost, view_against_real_rays, window_latency,
)  # fmt: skip


def main() -> int:
    """Measure and print a table; with --json print nothing but the figures as JSON."""
    as_json, names = "--json" in sys.argv[1:], [name for name in sys.argv[1:] if name != "--json"]
    parts = {part.__name__: part for part in PARTS}
    if unknown := [name for name in names if name not in parts]:
        print(f"no part {', '.join(unknown)}; there are {', '.join(parts)}", file=sys.stderr)
        return 2
    if not as_json:
        print(about_machine(), flush=True)
    figures: list[Figure] = []
    for part in [parts[name] for name in names] or PARTS:
        found = part()
        measured = [Figure(name, value, "") for name, value in found.items()] if isinstance(found, dict) else found
        figures += measured
        if not as_json:
            print(f"-- {part.__doc__.strip() if part.__doc__ else part.__name__}")
            print("\n".join(figure.line() for figure in measured), flush=True)
    text = to_json(as_data(figures))
    if not names:
        write_file(ROOT / "reports" / "bench.json", text)
        write_file(ROOT / "reports" / "bench.html", as_page(figures))
    if as_json:
        print(text)
    elif not names:
        print(f"written: {ROOT / 'reports' / 'bench.json'} and bench.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
