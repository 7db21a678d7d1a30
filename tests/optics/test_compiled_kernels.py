"""What is compiled: vectors as wide as is said, and a word on the terminal while it is."""

import io
import re

import numba as nb
import numpy as np
import pytest

from lensbench.optics.kernels import first_use, vector_bits

REGISTERS = {512: "zmm", 256: "ymm", 128: "xmm"}


class Terminal(io.StringIO):
    def isatty(self):
        return True


def halves(x, out):
    for i in nb.prange(x.size):
        out[i] = np.sqrt(x[i]) / (1 + x[i])


def test_loops_use_vectors_of_the_width_that_is_told():
    kernel = nb.njit(nb.void(nb.float64[::1], nb.float64[::1]), parallel=True, error_model="numpy")(halves)
    (assembly,) = kernel.inspect_asm().values()
    used = set(re.findall(r"v(?:sqrt|div)pd\s.*%([xyz]mm)", assembly))
    if not used:
        pytest.skip("not a processor of the x86 family with AVX")
    assert used == {REGISTERS[vector_bits()]}


@pytest.mark.parametrize("stream", [Terminal(), io.StringIO()])
def test_a_terminal_is_told_what_is_compiled_and_when_it_is_done(monkeypatch, stream):
    monkeypatch.setattr(first_use.sys, "stderr", stream)

    def doubled(x):
        return 2 * x

    doubled.__module__ = f"{first_use.__package__}.somewhere"
    assert nb.njit(doubled)(4) == 8
    told = stream.getvalue()
    assert bool(told) == stream.isatty()
    if told:
        assert re.search(r"compiling for this processor, once: kernel \d+, doubled, \d+ s", told)
        assert told.endswith(first_use.CLEAR)


def test_functions_of_others_are_compiled_without_a_word(monkeypatch):
    stream = Terminal()
    monkeypatch.setattr(first_use.sys, "stderr", stream)
    assert nb.njit(lambda x: x + 1)(4) == 5
    assert not stream.getvalue()
