"""Off-screen OpenGL for VTK: found out before VTK touches it, for VTK itself stops the process where it finds none."""

import ctypes
import os
import re
import sys
from functools import cache
from importlib.util import find_spec

from ..errors import LensBenchError

_DISPLAY_FREE = "vtkEGLRenderWindow"
_NEEDED = {
    "vtkEGLRenderWindow": ("libEGL.so.1", "libGL.so.1"),
    "vtkXOpenGLRenderWindow": ("libGL.so.1", "libX11.so.6"),
    "vtkOSOpenGLRenderWindow": ("libOSMesa.so.8",),
}
_PACKAGES = {
    "libEGL.so.1": "libegl1",
    "libGL.so.1": "libgl1",
    "libX11.so.6": "libx11-6",
    "libOSMesa.so.8": "libosmesa6",
}
_DRIVER = "libgl1-mesa-dri"
_EGL_PLATFORM_DEVICE = 0x313F


def require_gl() -> None:
    """Make VTK ready to draw off-screen. Raises LensBenchError that says what is missing and how to get it.

    Where no X display answers on Linux, VTK is told to use EGL, unless VTK_DEFAULT_OPENGL_WINDOW already names a window.
    """
    if find_spec("vtkmodules") is None:
        raise LensBenchError('pictures need VTK, which is not installed: pip install "lensbench[views]"')
    if sys.platform.startswith("linux"):
        if not display_answers():
            os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", _DISPLAY_FREE)
        _require_libraries(os.environ.get("VTK_DEFAULT_OPENGL_WINDOW", "vtkXOpenGLRenderWindow"))


def _require_libraries(window: str) -> None:
    missing = [name for name in _NEEDED.get(window, ()) if not _loads(name)]
    if missing:
        packages = " ".join(dict.fromkeys([*(_PACKAGES[name] for name in missing), _DRIVER]))
        raise LensBenchError(
            f"pictures need OpenGL, but {' and '.join(missing)} cannot be loaded: apt-get install {packages}"
        )
    if window == _DISPLAY_FREE and not _egl_starts():
        raise LensBenchError(f"pictures need OpenGL, but EGL finds no driver: apt-get install {_DRIVER}")


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


@cache
def display_answers() -> bool:
    """Whether DISPLAY names an X server that takes connections."""
    if not os.environ.get("DISPLAY") or not _loads("libX11.so.6"):
        return False
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    display = x11.XOpenDisplay(None)
    if display:
        x11.XCloseDisplay(display)
    return bool(display)


@cache
def _egl_starts() -> bool:
    """Whether one of EGL's devices, or its default display, can be initialised."""
    pointer = ctypes.c_void_p
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetProcAddress.restype = egl.eglGetDisplay.restype = pointer
    egl.eglGetDisplay.argtypes = [pointer]
    egl.eglInitialize.argtypes = [pointer, pointer, pointer]
    displays = [*_device_displays(egl), egl.eglGetDisplay(None)]
    return any(display and egl.eglInitialize(display, None, None) for display in displays)


def _device_displays(egl: ctypes.CDLL) -> list[int | None]:
    """EGL displays of the devices, graphics cards and software alike (EGL_EXT_device_enumeration, _platform_device)."""
    pointer, number = ctypes.c_void_p, ctypes.c_int
    query = egl.eglGetProcAddress(b"eglQueryDevicesEXT")
    display_of = egl.eglGetProcAddress(b"eglGetPlatformDisplayEXT")
    if not query or not display_of:
        return []
    devices, count = (pointer * 16)(), number(0)
    query_devices = ctypes.CFUNCTYPE(ctypes.c_uint, number, pointer, ctypes.POINTER(number))(query)
    if not query_devices(16, ctypes.cast(devices, pointer), ctypes.byref(count)):
        return []
    platform_display = ctypes.CFUNCTYPE(pointer, number, pointer, pointer)(display_of)
    return [platform_display(_EGL_PLATFORM_DEVICE, device, None) for device in devices[: count.value]]


def gl_report() -> dict[str, str]:
    """VTK's version, window class, OpenGL version and renderer of an off-screen window on this machine."""
    require_gl()
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
    from vtkmodules.vtkCommonCore import vtkVersion
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetSize(16, 16)
    window.Render()
    capabilities = window.ReportCapabilities()
    window.Finalize()

    def value(key: str) -> str:
        found = re.search(rf"OpenGL {key} string:\s*(.+)", capabilities)
        return found[1].strip() if found else "unknown"

    return {
        "vtk version": vtkVersion.GetVTKVersion(),
        "opengl window": window.GetClassName(),
        "opengl version": value("version"),
        "opengl renderer": value("renderer"),
    }
