"""What this installation consists of: for bug reports and for "it does not work here"."""

import os
import platform
from importlib.metadata import PackageNotFoundError, version

from . import __version__
from .errors import LensBenchError

PACKAGES = (
    "numpy", "scipy", "numba", "pydantic", "vtk", "pyvista", "matplotlib", "pillow", "jinja2", "embreex",
)  # fmt: skip


def examine() -> dict[str, str]:
    """Name and value of everything worth knowing; what is missing is said in the value."""
    found = {"lensbench": __version__, "python": platform.python_version(), "system": platform.platform()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = 'not installed (pip install "lensbench[report]")'
    import numba
    from llvmlite.binding import get_host_cpu_name

    from .optics.kernels import vector_bits

    found["threads"] = f"{numba.config.NUMBA_NUM_THREADS} of {os.cpu_count()} processors"
    found["vectors"] = f"{vector_bits()} bits on {get_host_cpu_name()}"
    try:
        from .views.offscreen import gl_report

        return found | gl_report()
    except (LensBenchError, ImportError) as error:
        return found | {"graphics": str(error)}
