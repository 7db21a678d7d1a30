"""Numba kernels: no classes, arrays of rays in, arrays out; compiled once and cached on disk.

The cache folder is named by a digest of these files, because numba does not notice an edit in the file of a callee.
NUMBA_CACHE_DIR overrides it. OpenMP threads spin for some microseconds, from one kernel of a trace to the next, and then
give way, unless OMP_WAIT_POLICY or GOMP_SPINCOUNT says otherwise: where other programs are busy too, a thread that spins on
keeps its own partner from running, tens of milliseconds at a time. On processors of AMD, whose gather instructions are
slower than single loads, none are used, unless NUMBA_CPU_FEATURES says otherwise.
"""

import hashlib
import os
import sys
from pathlib import Path

from llvmlite import binding
from numba.core import config


def _cache_folder() -> str:
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = base / "lensbench" / f"kernels-{digest.hexdigest()[:16]}"
    if not folder.exists() and sys.stderr is not None and sys.stderr.isatty():
        print("LensBench: compiling for this processor, once; this takes some 15 seconds", file=sys.stderr)
    return str(folder)


if "OMP_WAIT_POLICY" not in os.environ:
    os.environ["OMP_WAIT_POLICY"] = "passive"
    os.environ.setdefault("GOMP_SPINCOUNT", "10000")
if config.CPU_FEATURES is None and config.CPU_NAME is None and binding.get_host_cpu_name().startswith("znver"):
    config.CPU_FEATURES = f"{binding.get_host_cpu_features().flatten()},+prefer-no-gather"
_previous = config.CACHE_DIR
config.CACHE_DIR = _previous or _cache_folder()
from . import aim, outline, refract, surface, trace, transfer, voxels  # noqa: E402

config.CACHE_DIR = _previous

__all__ = ["aim", "outline", "refract", "surface", "trace", "transfer", "voxels"]
