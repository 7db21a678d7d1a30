"""What only a fresh process shows: the first call with and without the kernels' cache, and peak memory."""

import json
import os
import subprocess
import sys
import tempfile
import textwrap

from .figures import Figure
from .timing import ROOT

FIRST_MAP = """
    import json, time
    since = time.perf_counter()
    import lensbench as lb
    from lensbench.layers import MapLayer, Request
    from lensbench.workbench import run
    imported = time.perf_counter()
    lens = lb.load_lens("sample_lenses/{name}.toml")
    wearer = lb.load_wearer("sample_lenses/presbyope_60.toml")
    run(Request(lens, wearer, MapLayer("mean_power")))
    done = time.perf_counter()
    print(json.dumps([imported - since, done - since]))
"""
VOXELS = """
    import json
    from pathlib import Path
    def memory(name):
        return 1024 * int(Path("/proc/self/status").read_text().split(name + ":")[1].split()[0])
    bare = memory("VmRSS")
    import lensbench as lb
    from lensbench.layers import Request, VoxelLayer
    from lensbench.workbench import run
    lens = lb.load_lens("sample_lenses/regular_R.toml")
    wearer = lb.load_wearer("sample_lenses/young_astigmat.toml")
    run(Request(lens, wearer, VoxelLayer(2, 2, 2)))
    loaded = memory("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")
    voxels = run(Request(lens, wearer, VoxelLayer(64, 64, 256)))
    print(json.dumps([bare, loaded, memory("VmHWM"), voxels.blur.nbytes]))
"""


def first_calls() -> list[Figure]:
    """A first map of each lens in a fresh process: kernels compiled, and taken from the cache."""
    figures = []
    for model, name in (("sphere", "sphere_minus_4_R"), ("toric", "toric_R"), ("progressive", "regular_R")):
        with tempfile.TemporaryDirectory() as folder:
            cold, warm = (_answer(FIRST_MAP.format(name=name), NUMBA_CACHE_DIR=folder) for _ in range(2))
        figures.append(Figure(f"first map of a {model} lens, kernels compiled", cold[1], "s"))
        figures.append(Figure(f"first map of a {model} lens, kernels from the cache", warm[1], "s"))
    return [*figures, Figure("of which imports", warm[0], "s")]


def peak_memory() -> list[Figure]:
    """A job of 64 x 64 x 256 voxels in a fresh process whose kernels are compiled; where the system tells (Linux)."""
    if not sys.platform.startswith("linux"):
        return []
    _answer(VOXELS)
    bare, loaded, peak, result = (v / 1e6 for v in _answer(VOXELS))
    return [
        Figure("memory: Python alone", bare, "MB"),
        Figure("memory: LensBench, numba, scipy and the kernels loaded", loaded, "MB"),
        Figure("memory: the 64 x 64 x 256 voxels themselves", result, "MB"),
        Figure("memory: peak of the 64 x 64 x 256 job over what is loaded", peak - loaded, "MB", at_most=100),
    ]


def _answer(script: str, **environment: str) -> list[float]:
    """The numbers that a script prints as JSON in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)],
        cwd=ROOT, env=os.environ | {"PYTHONPATH": str(ROOT)} | environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return json.loads(done.stdout)
