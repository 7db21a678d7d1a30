"""The camera at the eye: where it stands, and the matrices between pixels, camera, head and the lens's edge."""

from typing import Any, NamedTuple

import numpy as np

from ...layers import SeenScene
from ...optics.conventions import Floats
from ...optics.lens_edge import LensEdge


class Frames(NamedTuple):
    """to_head (3, 3): camera's frame to head. to_device (4, 4): head to clip coordinates. from_pixel (3, 3): pixel (x, y, 1)
    from the window's lower left corner to a direction in the head's frame. size: of the renderer, pixels.
    """

    to_head: Floats
    to_device: Floats
    from_pixel: Floats
    size: tuple[int, int]


def place_camera(camera: Any, seen: SeenScene) -> None:
    """Put the camera at the eye, looking along the view; its horizontal field is the view's, whatever the window's shape."""
    camera.SetPosition(*seen.eye)
    camera.SetFocalPoint(*(seen.eye + 1000 * seen.frame[2]))
    camera.SetViewUp(*seen.frame[1])
    camera.UseHorizontalViewAngleOn()
    camera.SetViewAngle(2 * float(np.degrees(seen.layer.half_width)))
    camera.is_set = True  # else a PyVista plotter places its camera anew when it is shown or a mesh is added


def frames(renderer: Any, head: Floats) -> Frames:
    """The matrices of a renderer's camera as it stands, for a head (3, 3)."""
    camera, (width, height), (left, low) = renderer.GetActiveCamera(), renderer.GetSize(), renderer.GetOrigin()
    to_camera = _matrix(camera.GetViewTransformMatrix())[:3, :3] @ head
    projection = _matrix(camera.GetProjectionTransformMatrix(renderer.GetTiledAspectRatio(), -1, 1))
    to_device = projection @ np.block([[to_camera, np.zeros((3, 1))], [np.zeros(3), 1.0]])
    across, up = 2 / width / projection[0, 0], 2 / height / projection[1, 1]
    from_pixel = np.array([[across, 0, -across * (left + width / 2)], [0, up, -up * (low + height / 2)], [0, 0, -1.0]])
    return Frames(to_camera.T, to_device, to_camera.T @ from_pixel, (width, height))


def _matrix(matrix: Any) -> Floats:
    return np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])


def edge_in_view(edge: LensEdge, found: Frames) -> bool:
    """Whether a part of the lens's edge lies in the picture or close to it."""
    clip = np.column_stack([edge.directions(), np.ones(edge.radius.size)]) @ found.to_device.T
    ahead = clip[:, 3] > 0
    return bool((ahead & (np.abs(clip[:, :2]) < 1.02 * clip[:, 3:]).all(axis=1)).any())


def camera_state(renderer: Any) -> tuple[Any, ...]:
    """What of a renderer's camera and size decides how a picture looks."""
    camera = renderer.GetActiveCamera()
    return (
        renderer.GetSize(),
        renderer.GetOrigin(),
        camera.GetPosition(),
        camera.GetFocalPoint(),
        camera.GetViewUp(),
        camera.GetViewAngle(),
    )
