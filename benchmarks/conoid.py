"""python -m benchmarks.conoid: tables and picture of docs/conoid.md, the paper's two schemes and ours against real rays."""

import numpy as np

import lensbench as lb
from lensbench.optics.conventions import Floats
from lensbench.output import write_file
from lensbench.views.maps import save_picture

from . import kakimoto, schemes
from .timing import ROOT
from .wide_field import wide_figure

PAGE = ROOT / "docs" / "conoid.md"
PLANES = (270.0, 780.0, 3400.0)
GRID = lb.GazeGrid(32, 32, float(np.radians(25)), float(np.radians(25)))
WIDE = "toric -6 -3.5 x 20, eye -6.00 -3.50 x 35"
HEAD = ("lens, eye", "plane", "ours", "Table 1", "Table 2")
READINGS_HEAD = ("lens, eye", "plane", "along e1' after the surface", "plane of incidence", "world's x")


def main() -> None:
    """Measure; write the tables into the page and its picture beside it."""
    rms, major, readings = [], [], []
    for name, (lens, wearer) in schemes.cases().items():
        field = schemes.passing_field(lens, wearer, GRID)
        for plane in PLANES:
            row = [name, f"{plane / 10:g} cm"]
            real = schemes.real_ellipses(field, plane)
            found = [
                schemes.sizes(blur(field, plane)) for blur in (schemes.ours, schemes.by_table_1, schemes.by_table_2)
            ]
            for rows, k in ((rms, 0), (major, 1)):
                rows.append([*row, *(error(one[k], real[k]) for one in found)])
            by_reading = [schemes.sizes(schemes.by_table_2(field, plane, reading))[0] for reading in kakimoto.READINGS]
            readings.append([*row, *(f"{error(one, real[0])}, {np.isnan(one).mean():.1%}" for one in by_reading)])
    page = PAGE.read_text(encoding="utf-8")
    for name, text in (
        ("rms", table(HEAD, rms)),
        ("major", table(HEAD, major)),
        ("readings", table(READINGS_HEAD, readings)),
    ):
        page = between(page, name, text)
    write_file(PAGE, page)
    save_picture(wide_figure(*schemes.cases()[WIDE], WIDE), PAGE.with_name("conoid.png"))


def between(page: str, name: str, text: str) -> str:
    """The page with the text between the marks of that name."""
    before, rest = page.split(f"<!-- {name}: python -m benchmarks.conoid -->")
    return (
        f"{before}<!-- {name}: python -m benchmarks.conoid -->\n{text}\n<!-- end -->{rest.split('<!-- end -->', 1)[1]}"
    )


def table(head: tuple[str, ...], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def error(mine: Floats, real: Floats) -> str:
    """Median and 90th percentile of the relative error, where there is an answer."""
    off = np.abs(mine / real - 1)
    if not np.isfinite(off).any():
        return "-"
    return " / ".join(f"{p:.1%}" for p in np.nanpercentile(off, [50, 90]))


if __name__ == "__main__":
    main()
