"""The sum of the passes in linear light: in 32-bit floats on the graphics card, or in the computer's memory."""

from typing import Any, Protocol

import numpy as np
from numba import njit
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR, vtkUnsignedCharArray
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLFramebufferObject, vtkOpenGLQuadHelper, vtkTextureObject

from ...errors import LensBenchError
from . import shaders
from .light import LIGHT_OF_CODE, Light, Pixels, encode

Box = tuple[int, int, int, int]

_RGBA32F, _FLOAT = 0x8814, 0x1406
_BLEND, _DEPTH_TEST, _COLOUR_BUFFER, _FRAMEBUFFER = 0x0BE2, 0x0B71, 0x4000, 0x8D40
_ONE, _SOURCE_ALPHA, _ONE_LESS_SOURCE_ALPHA = 1, 0x0302, 0x0303


class Accumulator(Protocol):
    """Sums what a window draws. Its methods belong between the start and the end of the window's rendering."""

    def clear(self, size: tuple[int, int], part: Box) -> None:
        """Begin anew, for a part of a window of size (width, height)."""

    def add(self) -> None:
        """Add the window's picture as it stands in its frame buffer."""

    def show(self, exposure: float) -> None:
        """Draw the mean of the passes into the window's frame buffer."""

    def light(self) -> Light:
        """Mean light (h, w, 3) of the passes, first row at the top."""

    def release(self) -> None:
        """Free what is held on the graphics card."""


class CardSum:
    """Additive blending into a texture of four 32-bit floats on the graphics card; alpha counts the passes."""

    def __init__(self, window: Any) -> None:
        self.window = window
        self.size, self.part = (0, 0), (0, 0, 0, 0)
        self.texture, self.frame = vtkTextureObject(), vtkOpenGLFramebufferObject()
        self.adding, self.adder = _quad(window, shaders.ADD)
        self.resolving, self.resolver = _quad(window, shaders.RESOLVE)

    def clear(self, size: tuple[int, int], part: Box) -> None:
        """Begin anew, for a part of a window of size (width, height)."""
        state = self.window.GetState()
        state.PushFramebufferBindings()
        if size != self.size:
            self._allocate(size)
        self.part = part
        self._aim()
        state.vtkglClearColor(0.0, 0.0, 0.0, 0.0)
        state.vtkglClear(_COLOUR_BUFFER)
        state.PopFramebufferBindings()

    def _allocate(self, size: tuple[int, int]) -> None:
        """A new texture and frame buffer: those of another size cannot be grown."""
        self._free()
        self.texture, self.frame, self.size = vtkTextureObject(), vtkOpenGLFramebufferObject(), size
        self.texture.SetContext(self.window)
        self.texture.SetInternalFormat(_RGBA32F)
        self.texture.SetDataType(_FLOAT)
        self.texture.Allocate2D(*size, 4, VTK_UNSIGNED_CHAR)
        self.frame.SetContext(self.window)
        self.frame.Bind()
        self.frame.AddColorAttachment(0, self.texture)
        self.frame.ActivateDrawBuffer(0)
        if not self.frame.CheckFrameBufferStatus(_FRAMEBUFFER):
            raise LensBenchError("the graphics driver cannot add into 32-bit floats")

    def _free(self) -> None:
        self.frame.ReleaseGraphicsResources(self.window)
        self.texture.ReleaseGraphicsResources(self.window)

    def _aim(self) -> None:
        state = self.window.GetState()
        self.frame.Bind()
        self.frame.ActivateDrawBuffer(0)
        state.vtkglViewport(0, 0, *self.size)
        state.vtkglScissor(*self.part)

    def add(self) -> None:
        """Add the window's picture as it stands in its frame buffer."""
        state = self.window.GetState()
        drawn = self.window.GetRenderFramebuffer().GetColorAttachmentAsTextureObject(0)
        state.PushFramebufferBindings()
        self._aim()
        state.vtkglEnable(_BLEND)
        state.vtkglBlendFuncSeparate(_ONE, _ONE, _ONE, _ONE)
        self._draw(self.adding, self.adder, drawn)
        state.vtkglBlendFuncSeparate(_SOURCE_ALPHA, _ONE_LESS_SOURCE_ALPHA, _ONE, _ONE_LESS_SOURCE_ALPHA)
        state.PopFramebufferBindings()

    def show(self, exposure: float) -> None:
        """Draw the mean of the passes into the window's frame buffer."""
        state = self.window.GetState()
        frame = self.window.GetRenderFramebuffer()
        state.PushFramebufferBindings()
        frame.Bind()
        frame.ActivateDrawBuffer(0)
        state.vtkglViewport(0, 0, *self.size)
        state.vtkglScissor(*self.part)
        state.vtkglDisable(_BLEND)
        self.window.GetShaderCache().ReadyShaderProgram(self.resolver)
        self.resolver.SetUniformf("jitExposure", exposure)
        self._draw(self.resolving, self.resolver, self.texture)
        state.vtkglEnable(_BLEND)
        state.PopFramebufferBindings()

    def _draw(self, quad: Any, program: Any, source: Any) -> None:
        state = self.window.GetState()
        state.vtkglDisable(_DEPTH_TEST)
        self.window.GetShaderCache().ReadyShaderProgram(program)
        source.Activate()
        program.SetUniformi("jitSource", source.GetTextureUnit())
        quad.Render()
        source.Deactivate()
        state.vtkglEnable(_DEPTH_TEST)

    def light(self) -> Light:
        """Mean light (h, w, 3) of the passes, first row at the top."""
        width, height = self.size
        buffer = self.texture.Download()
        try:
            total = np.empty((height, width, 4), dtype=np.float32)
            dims, increments = [width, height], [0, 0]
            buffer.Download2D(10, total, dims, 4, increments)
        finally:
            buffer.UnRegister(None)
        left, low, wide, high = self.part
        total = total[low : low + high, left : left + wide][::-1]
        return total[..., :3] / total[..., 3:]

    def release(self) -> None:
        """Free what is held on the graphics card."""
        self._free()
        self.adding = self.resolving = self.adder = self.resolver = None


def _quad(window: Any, source: str) -> tuple[Any, Any]:
    """A full-screen quad and its program."""
    quad = vtkOpenGLQuadHelper(window, None, source, None)
    program = window.GetShaderCache().GetLastShaderBound()
    if program is None or not program.GetCompiled():
        raise LensBenchError("the graphics driver refused the shader that adds the passes")
    return quad, program


class MemorySum:
    """The same in the computer's memory, for a driver that cannot add floats: every pass is read back."""

    def __init__(self, window: Any) -> None:
        self.window = window
        self.passes, self.corners = 0, (0, 0, 0, 0)
        self.total = np.zeros((0, 0, 3), dtype=np.float32)
        self.pixels = vtkUnsignedCharArray()

    def clear(self, size: tuple[int, int], part: Box) -> None:
        """Begin anew, for a part of a window of size (width, height)."""
        left, low, width, height = part
        self.passes, self.corners = 0, (left, low, left + width - 1, low + height - 1)
        self.total = np.zeros((height, width, 3), dtype=np.float32)

    def add(self) -> None:
        """Add the window's picture as it stands in its frame buffer."""
        height, width, _ = self.total.shape
        self.window.GetRGBACharPixelData(*self.corners, 0, self.pixels)
        add_light(vtk_to_numpy(self.pixels).reshape(height, width, 4), LIGHT_OF_CODE, self.total)
        self.passes += 1

    def show(self, exposure: float) -> None:
        """Draw the mean of the passes into the window's frame buffer."""
        codes = encode(self.total * np.float32(exposure / self.passes))
        pixels = vtkUnsignedCharArray()
        pixels.SetNumberOfComponents(3)
        pixels.SetArray(codes.ravel(), codes.size, 1)
        self.window.SetPixelData(*self.corners, pixels, 0, 0)

    def light(self) -> Light:
        """Mean light (h, w, 3) of the passes, first row at the top."""
        return self.total[::-1] / np.float32(self.passes)

    def release(self) -> None:
        """Nothing is held on the graphics card."""


@njit(nogil=True, cache=True)
def add_light(codes: Pixels, light_of_code: Light, total: Light) -> None:
    """Add the light of sRGB codes (h, w, 4) to the total (h, w, 3), in place."""
    for i in range(codes.shape[0]):
        for j in range(codes.shape[1]):
            for c in range(3):
                total[i, j, c] += light_of_code[codes[i, j, c]]
