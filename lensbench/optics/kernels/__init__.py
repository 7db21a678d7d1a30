"""Numba kernels: no classes, arrays of rays in, arrays out; compiled once and cached on disk.

The cache folder is named by a digest of these files, because numba does not notice an edit in the file of a callee.
NUMBA_CACHE_DIR overrides it. OpenMP threads spin for some microseconds, from one kernel of a trace to the next, and then
give way, unless OMP_WAIT_POLICY or GOMP_SPINCOUNT says otherwise: where other programs are busy too, a thread that spins on
keeps its own partner from running, tens of milliseconds at a time. Unless NUMBA_CPU_FEATURES says otherwise, vectors are as
wide as the processor has them, 512 bits with AVX-512, where LLVM by itself takes half of that on processors of Intel: 1.4 to
1.6 times as many rays in the same time. On processors of AMD, whose gather instructions are slower than single loads, none
are used.
"""

import hashlib
import os
from pathlib import Path

from llvmlite import binding
from numba.core import config, event

from .first_use import Progress


def _cache_folder() -> str:
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return str(base / "lensbench" / f"kernels-{digest.hexdigest()[:16]}")


def _preferences() -> list[str]:
    """How LLVM is to use what the processor has."""
    wide = ["-prefer-256-bit"] if binding.get_host_cpu_features().get("avx512f") else []
    return [*wide, "+prefer-no-gather"] if binding.get_host_cpu_name().startswith("znver") else wide


def vector_bits() -> int:
    """The width of the vectors in which the kernels are compiled."""
    features = (config.CPU_FEATURES or "").split(",")
    if "+avx512f" in features and "-prefer-256-bit" in features:
        return 512
    return 256 if "+avx" in features else 128


if "OMP_WAIT_POLICY" not in os.environ:
    os.environ["OMP_WAIT_POLICY"] = "passive"
    os.environ.setdefault("GOMP_SPINCOUNT", "10000")
if config.CPU_FEATURES is None and config.CPU_NAME is None:
    config.CPU_FEATURES = ",".join([binding.get_host_cpu_features().flatten(), *_preferences()])
event.register("numba:compile", Progress())
_previous = config.CACHE_DIR
config.CACHE_DIR = _previous or _cache_folder()
from . import aim, outline, refract, surface, trace, transfer, voxels  # noqa: E402

config.CACHE_DIR = _previous

__all__ = ["aim", "outline", "refract", "surface", "trace", "transfer", "vector_bits", "voxels"]
