"""A measured figure with its target, and the two pages that hold them all."""

import html
import platform
import sys
from dataclasses import asdict, dataclass
from importlib.metadata import version

import numba
from llvmlite.binding import get_host_cpu_name

import lensbench as lb
from lensbench.optics import surfaces
from lensbench.optics.gaze import trace_rays
from lensbench.optics.kernels import vector_bits
from lensbench.optics.lens import Lens, circle_outline
from lensbench.optics.materials import MATERIALS

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
    """On what it was measured, and what decides the kernels' speed there."""
    packages = {name: version(name) for name in ("numpy", "numba")}
    return {
        "processor": f"{processor()} ({get_host_cpu_name()})",
        "vectors": f"{vector_bits()} bits",
        "threads": f"{numba.get_num_threads()} ({threading_layer()})",
        "system": platform.platform(),
        "python": platform.python_version(),
        **packages,
    }


def processor() -> str:
    """The processor's name, as the system tells it."""
    if sys.platform == "linux":
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
        return names[0] if names else platform.machine()
    return platform.processor() or platform.machine()


def threading_layer() -> str:
    """What shares the work between numba's threads: known after a first ray."""
    lens = Lens(surfaces.sphere(100.0), surfaces.sphere(100.0), 2.0, MATERIALS["MR-8"], circle_outline(70.0))
    trace_rays(lens, lb.Wear(), [[0.0, 0.0, -27.0]], [[0.0, 0.0, 1.0]])
    return str(numba.threading_layer())


def about_machine() -> str:
    """The same in one line."""
    return ", ".join(f"{name} {value}" for name, value in machine().items())


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
    return PAGE.format(machine=html.escape(about_machine()), rows=rows)
