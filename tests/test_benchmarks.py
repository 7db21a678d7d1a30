"""What reports the benchmarks: figures with targets, and the truth that docs/conoid.md measures by."""

from dataclasses import replace

import numba
import numpy as np
import pytest
from llvmlite.binding import get_host_cpu_name

import lensbench as lb
from benchmarks import schemes
from benchmarks.figures import Figure, about_machine, as_data, as_page, processor
from lensbench.cli import machine, main
from lensbench.optics.kernels import vector_bits


@pytest.mark.parametrize(
    ("figure", "verdict"),
    [
        (Figure("speed", 12.0, "x", at_least=10), "met"),
        (Figure("speed", 9.9, "x", at_least=10), "missed"),
        (Figure("wait", 4.0, "ms", at_most=5), "met"),
        (Figure("wait", 5.1, "ms", at_most=5), "missed"),
        (Figure("wait", float("nan"), "ms", at_most=5), "missed"),
        (Figure("size", 4.0, "MB"), ""),
    ],
)
def test_a_figure_against_its_target(figure, verdict):
    assert figure.verdict == verdict
    assert figure.line().endswith(verdict)


def test_a_page_of_figures_is_escaped_and_says_where():
    figures = [Figure("a < b", 1.5, "ms", at_most=2)]
    assert "a &lt; b" in as_page(figures)
    assert as_data(figures)["figures"] == [
        {"name": "a < b", "value": 1.5, "unit": "ms", "at_most": 2, "verdict": "met"}
    ]
    assert as_data(figures)["machine"]["threads"] in as_page(figures)


def test_the_head_names_what_decides_the_kernels_speed():
    head = about_machine()
    assert head.startswith(f"processor {processor()} ({get_host_cpu_name()}), vectors {vector_bits()} bits, threads ")
    assert f"{numba.get_num_threads()} ({numba.threading_layer()})" in head


def test_bench_needs_a_checkout(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(machine, "__file__", str(tmp_path / "site-packages" / "lensbench" / "cli" / "machine.py"))
    assert main(["bench"]) == 1
    assert "checkout" in capsys.readouterr().err


def test_real_ellipses_of_a_tiny_pupil_are_those_of_the_field():
    lens, wearer = schemes.cases()["toric -2.00 -1.50 x 20, its eye"]
    wearer = replace(wearer, eye=replace(wearer.eye, pupil_diameter=0.1))
    field = lb.trace(lens, wearer, lb.GazeGrid(3, 3, 0.3, 0.3))
    ours = schemes.sizes(field.blur(schemes.distance(field, 780.0)))
    np.testing.assert_allclose(schemes.real_ellipses(field, 780.0), ours, rtol=1e-4)
