"""A measured figure with its target, and the two pages that hold them all."""

import html
import platform
from dataclasses import asdict, dataclass
from importlib.metadata import version

import numba

PAGE = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>LensBench: measured speed</title>
<style>
body {{ font: 15px/1.4 system-ui, sans-serif; margin: 2em auto; max-width: 60em; color: #222 }}
table {{ border-collapse: collapse; width: 100% }}
td, th {{ padding: .25em .8em; border-bottom: 1px solid #ddd; text-align: left }}
td.n {{ text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap }}
.met {{ color: #11662a }} .missed {{ color: #a3171f; font-weight: 600 }}
</style>
<h1>LensBench: measured speed</h1><p>{machine}</p>
<table><thead><tr><th>figure<th>measured<th>target<th></tr></thead><tbody>
{rows}
</tbody></table></html>
"""


@dataclass(frozen=True, slots=True)
class Figure:
    """A measured value; at_least or at_most: its target, where it has one."""

    name: str
    value: float
    unit: str
    at_least: float | None = None
    at_most: float | None = None

    @property
    def target(self) -> str:
        """The target in words."""
        if self.at_least is not None:
            return f"at least {self.at_least:g}"
        return "" if self.at_most is None else f"at most {self.at_most:g}"

    @property
    def verdict(self) -> str:
        """Whether the target is met; empty without one."""
        if not self.target:
            return ""
        low, high = self.at_least or float("-inf"), float("inf") if self.at_most is None else self.at_most
        return "met" if low <= self.value <= high else "missed"

    def line(self) -> str:
        """For the terminal."""
        return f"{self.name:<70} {self.value:>11.5g} {self.unit:<8} {self.target:<15} {self.verdict}".rstrip()


def machine() -> dict[str, str]:
    """On what it was measured."""
    packages = {name: version(name) for name in ("numpy", "numba")}
    return {
        "processor": platform.processor() or platform.machine(),
        "threads": str(numba.get_num_threads()),
        "system": platform.platform(),
        "python": platform.python_version(),
        **packages,
    }


def as_data(figures: list[Figure]) -> dict[str, object]:
    """What reports/bench.json holds."""
    rows = [{k: v for k, v in asdict(f).items() if v is not None} | {"verdict": f.verdict} for f in figures]
    return {"machine": machine(), "figures": rows}


def as_page(figures: list[Figure]) -> str:
    """A self-contained HTML table."""
    rows = "\n".join(
        f'<tr><td>{html.escape(f.name)}<td class="n">{f.value:.4g} {html.escape(f.unit)}'
        f'<td>{f.target}<td class="{f.verdict}">{f.verdict}'
        for f in figures
    )
    about = ", ".join(f"{name} {value}" for name, value in machine().items())
    return PAGE.format(machine=html.escape(about), rows=rows)
