"""The simulated view: what a pass costs against a plain render, how soon a change is seen, and how near real rays it comes."""

import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

import lensbench as lb
from lensbench.layers import Request, SeenScene, ViewLayer
from lensbench.scenes.builtin import load_scene
from lensbench.scenes.scene import Scene
from lensbench.workbench import look, run

from .timing import ROOT, rounds

SIZE = (1280, 1024)
SMALL = (192, 144)
FEW = {"page", "screen", "table", "wall", "slide", "clock", "door", "poster", "window", "lamp"}


def view_cost() -> dict[str, float]:
    """A pass and the first picture after a change, as multiples of a plain VTK render of the same scene in the same run."""
    from lensbench.views.jitter import Studio

    lens, wearer, room = _case()
    scene = replace(room, parts=tuple(part for part in room.parts if part.name in FEW), sky=None)
    whole = run(Request(lens, wearer, ViewLayer("lens", *look("far", lens, wearer, room), np.radians(25), SIZE), scene))
    cut = run(Request(lens, wearer, replace(whole.layer, half_width=np.radians(45)), scene))
    plain, unmipped, plain_cut = _plain(whole, True), _plain(whole, False), _plain(cut, True)
    with Studio() as one, Studio() as other:
        passes = [_one_pass(one, whole), _one_pass(other, cut)]
        costs = rounds(plain, unmipped, plain_cut, *passes, count=9)
    with Studio() as studio:
        changes = [_first_picture(studio, scene, whole, kind) for kind in ("pupil", "head", "thickness")]
        firsts = rounds(plain, *changes, count=9)
    return {
        "view: triangles": float(sum(len(part.triangles) for part in scene.drawn)),
        "view: plain render, mipmaps, ms": 1e3 * costs[0],
        "view: plain render, no mipmaps, ms": 1e3 * costs[1],
        "view: pass / plain render": costs[3] / costs[0],
        "view: pass / plain render without mipmaps": costs[3] / costs[1],
        "view: pass with the lens's edge / plain render": costs[4] / costs[2],
        "view: first picture, new pupil / plain": firsts[1] / firsts[0],
        "view: first picture, head turned / plain": firsts[2] / firsts[0],
        "view: first picture, new lens / plain": firsts[3] / firsts[0],
        "view: growth over 300 passes, MB": _growth(whole),
    }


def view_against_real_rays() -> dict[str, float]:
    """PSNR (dB) of the room, looking near, against 128 real rays a pixel, by the number of passes."""
    sys.path.insert(0, str(ROOT / "tests"))
    import real_view

    from lensbench.views.jitter import Studio, encode

    lens, wearer, scene = _case()
    layer = ViewLayer("lens", *look("near", lens, wearer, scene), np.radians(20), SMALL)
    seen = run(Request(lens, wearer, layer, scene))
    room = real_view.TexturedScene(seen.scene)
    y, x = (a.ravel() + 0.5 for a in np.mgrid[: SMALL[1], : SMALL[0]])
    light = real_view.picture_light(lens, wearer, layer, np.stack([x, y], axis=1), room.shade, 128, room.meet)
    reference = encode(light.reshape(SMALL[1], SMALL[0], 3))
    with Studio() as studio:
        return {
            f"view: PSNR, {n} passes, dB": real_view.psnr(studio.picture(seen, n), reference) for n in (16, 64, 256)
        }


def _case() -> tuple[Any, Any, Any]:
    lens = lb.load_lens(ROOT / "sample_lenses" / "regular_R.toml")
    return lens, lb.load_wearer(ROOT / "sample_lenses" / "presbyope_60.toml"), load_scene("room")


def _plain(seen: SeenScene, mipmaps: bool) -> Callable[[], Any]:
    """A plain VTK render of the view's scene, read back."""
    from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
    from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow

    from lensbench.views.jitter.camera import place_camera
    from lensbench.views.jitter.parts import image_texture, part_actor

    window, renderer, pixels = vtkRenderWindow(), vtkRenderer(), vtkUnsignedCharArray()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(*SIZE)
    window.AddRenderer(renderer)
    for part in seen.scene.drawn:
        texture = image_texture(part.image)
        texture.SetMipmap(mipmaps)
        renderer.AddActor(part_actor(part, texture))
    place_camera(renderer.GetActiveCamera(), seen)
    renderer.ResetCameraClippingRange()

    def draw() -> None:
        window.Render()
        window.GetRGBACharPixelData(0, 0, SIZE[0] - 1, SIZE[1] - 1, 0, pixels)

    return draw


def _one_pass(studio: Any, seen: SeenScene) -> Callable[[], Any]:
    studio.window.SetSize(*SIZE)
    studio.view.sample(100)
    studio.view.show(seen)
    studio.view.displayed = False
    return studio.window.Render  # type: ignore[no-any-return]


def _first_picture(studio: Any, scene: Scene, seen: SeenScene, what: str) -> Callable[[], Any]:
    """From a changed parameter to the first pass as pixels."""
    step = iter(range(1, 1000))

    def change() -> None:
        k = next(step)
        lens, wearer, layer = seen.lens, seen.wearer, seen.layer
        if what == "pupil":
            wearer = replace(wearer, eye=replace(wearer.eye, pupil_diameter=3 + 0.01 * k))
        elif what == "head":
            layer = replace(layer, head_turn=0.001 * k)
        else:
            lens = replace(lens, centre_thickness=2 + 0.01 * k)
        studio.picture(run(Request(lens, wearer, layer, scene)), 1)

    return change


def _growth(seen: SeenScene) -> float:
    """By how much the process grows over 300 passes, MB."""
    import psutil

    from lensbench.views.jitter import Studio

    with Studio() as studio:
        studio.picture(seen, 30)
        before = psutil.Process().memory_info().rss
        studio.picture(seen, 300)
        return (psutil.Process().memory_info().rss - before) / 1e6
