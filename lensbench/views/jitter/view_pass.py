"""Multipass vertex jitter for any VTK renderer: every rendering of its window is one pass, and the passes are averaged."""

from typing import Any

import numpy as np
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

from ...errors import LensBenchError
from ...layers import SeenPart, SeenScene
from ...optics.conventions import Floats
from ...seen import parts_by_zone
from .accumulate import CardSum, MemorySum
from .camera import camera_state, edge_in_view, frames, place_camera
from .context import in_own_context
from .light import Light, pixel_shifts, pupil_points
from .parts import image_texture, part_actor, rim_actor, twin_of, vertex_actor
from .zones import Zone

_FIRST_UNIT = 0x84C0

ZonesParts = tuple[tuple[SeenPart, ...], tuple[SeenPart, ...]]


class VerticesNeeded(LensBenchError):
    """The driver takes the view only vertex by vertex, and nobody has traced them."""


class JitterPass:
    """What the wearer sees, drawn by a renderer that already belongs to a window (on screen, off screen, or Qt's).

    Each window.Render() draws one pass: all vertices displaced for one point of the pupil. Its light is added to that of
    the passes before, and their mean is shown; any change of camera, size, scene, lens, eye or head begins anew. Between
    passes only uniforms change.

        view = JitterPass(plotter.render_window, plotter.renderer, passes=64)
        view.show(workbench.run(Request(lens, wearer, ViewLayer(...), scene)))   # and again after each edit
        while not view.done:                                                     # in a window: a timer of 0 ms
            plotter.render_window.Render()
        view.close()                                                             # before the window closes

    show() places the camera. It may be turned afterwards, and moved, which moves head and lens along. Multisampling and
    frustum culling are switched off: passes smooth edges, and what stands outside the frustum is refracted into view.
    exposure (factor on the light), paused (draw without adding, for picking), displayed (show the mean after each pass; off
    screen the last one is enough) and traces (trace vertices here; else show() raises VerticesNeeded where it lacks them) may
    be set at any time.
    by_vertices: exact chief rays of each vertex instead of the field's atlas: slow when lens or head change. in_memory: sum
    in the computer's memory. Both are chosen where the driver refuses the other; LensBenchError if it refuses all.
    """

    def __init__(
        self,
        window: Any,
        renderer: Any,
        passes: int = 64,
        seed: int = 0,
        *,
        by_vertices: bool = False,
        in_memory: bool = False,
    ) -> None:
        self.window, self.renderer, self.by_vertices = window, renderer, by_vertices
        self.exposure, self.paused, self.displayed, self.traces = 1.0, False, True, True
        self._parts: ZonesParts | None = None
        self.seen: SeenScene | None = None
        self._drawn: tuple[Any, ...] = ()
        self.sample(passes, seed)
        self._clipping = 1.0, 1e5
        self._added: list[Floats] = []  # lowest and highest corner (2, 3) of each actor that was added
        window.SetMultiSamples(0)
        renderer.GetCullers().RemoveAllItems()
        window.Render()
        self._sum = MemorySum(window) if in_memory else _best_sum(window)
        self._zones = self._new_zones()
        self._culls = "GL_ARB_cull_distance" in window.ReportCapabilities()
        self._tags = [
            renderer.AddObserver(event, action, -1.0)
            for event, action in (("StartEvent", self._start), ("EndEvent", self._end))
        ]

    def sample(self, passes: int, seed: int = 0) -> None:
        """Average over so many points of the pupil, in an order drawn from the seed; the picture begins anew."""
        self.passes = passes
        self._points, self._shifts = pupil_points(passes, seed), pixel_shifts(passes)
        self.reset()

    @in_own_context
    def show(self, seen: SeenScene, parts: ZonesParts | None = None) -> None:
        """Show a scene as this eye sees it; the picture begins anew. What is as before stays on the graphics card.

        parts: its vertices one by one, where they were traced beforehand (seen.parts_by_zone).
        """
        before, self.seen, self._parts = self.seen, seen, parts
        if before is None or self.by_vertices or seen.scene is not before.scene:
            self._set_scene(seen)
        self._set_reach(seen.eye)
        for zone, atlas in zip(self._zones, (seen.through, seen.around, seen.through, None), strict=True):
            if atlas is not None:
                zone.see(seen, atlas)
        if before is None or seen.edge is not before.edge:
            self._set_rim(seen)
        place_camera(self.renderer.GetActiveCamera(), seen)
        if before is None:
            self._prove()
        self.reset()

    @in_own_context
    def add(self, actor: Any) -> None:
        """Let another actor, which stands in the scene's frame (mm), be seen through the lens instead, until the scene changes.

        It must draw a vtkPolyData, whose triangles should be small (2 degrees); it is taken out of the renderer.
        """
        if self.by_vertices:
            raise LensBenchError("other actors are seen through the lens only by the field's atlas")
        self._added.append(np.array(actor.GetBounds()).reshape(3, 2).T)
        self._set_reach(np.array(self.renderer.GetActiveCamera().GetPosition()))
        self.renderer.RemoveActor(actor)
        for zone in self._zones[:2]:
            self.renderer.AddActor(zone.take(twin_of(actor)))
        self.reset()

    def reset(self) -> None:
        """Begin anew, after a change that the pass cannot see, as that of an actor's colour."""
        self.count, self._drawn = 0, ()

    @property
    def done(self) -> bool:
        """Whether all passes are drawn, and the camera has not moved since."""
        return self.count >= self.passes and self._drawn == camera_state(self.renderer)

    @in_own_context
    def light(self) -> Light:
        """Mean light (h, w, 3) of the passes so far, linear, first row at the top; the exposure is left to you."""
        return self._sum.light()

    @in_own_context
    def close(self) -> None:
        """Take the scene out of the renderer and free what is held on the graphics card: before the window closes."""
        for tag in self._tags:
            self.renderer.RemoveObserver(tag)
        for zone in self._zones:
            self._fill(zone, [])
            zone.release()
        self._sum.release()

    def _traced(self, seen: SeenScene) -> ZonesParts:
        if not self.traces:
            raise VerticesNeeded("the graphics driver refused the shader of the view: it needs each vertex traced")
        return parts_by_zone(seen)

    def _new_zones(self) -> tuple[Zone, Zone, Zone, Zone]:
        kind = "vertices" if self.by_vertices else "atlas"
        through, around = Zone(self.window, kind), Zone(self.window, kind, -1)
        return through, around, Zone(self.window, kind, core_of=through), Zone(self.window, "rim")

    def _fill(self, zone: Zone, actors: list[Any]) -> None:
        for actor in zone.actors:
            self.renderer.RemoveActor(actor)
        zone.actors.clear()
        for actor in actors:
            self.renderer.AddActor(zone.take(actor))

    def _set_scene(self, seen: SeenScene) -> None:
        self.renderer.SetBackground(*(code / 255 for code in seen.scene.background))
        self._added = []
        textures = [image_texture(part.image) for part in seen.scene.drawn]
        if self.by_vertices:
            through, around = self._parts or self._traced(seen)
            found = through, around, through
            actors = [[vertex_actor(*pair) for pair in zip(parts, textures, strict=False)] for parts in found]
        else:
            actors = [[part_actor(*pair) for pair in zip(seen.scene.drawn, textures, strict=True)] for _ in range(3)]
        for zone, of_zone in zip(self._zones, actors, strict=False):
            self._fill(zone, of_zone)
        self._set_rim(seen)

    def _set_reach(self, eye: Floats) -> None:
        """Clip before and behind what stands in the scene, however it is refracted."""
        assert self.seen is not None
        reach = [np.linalg.norm(part.points - eye, axis=1) for part in self.seen.scene.drawn]
        for low, high in self._added:
            farthest = np.where(np.abs(low - eye) > np.abs(high - eye), low, high)
            reach.append(np.linalg.norm([np.clip(eye, low, high) - eye, farthest - eye], axis=1))
        nearest, last = (float(pick(np.concatenate(reach))) for pick in (np.min, np.max))
        self._clipping = 0.5 * max(nearest, 1e-4 * last), 2.0 * last

    def _set_rim(self, seen: SeenScene) -> None:
        rim = [] if seen.edge is None else [rim_actor(seen.edge)]
        self._fill(self._zones[3], rim)

    def _start(self, *_: Any) -> None:
        """Before the renderer draws: this pass's uniforms, and all else if the camera has moved."""
        if self.seen is None:
            return
        self.renderer.GetActiveCamera().SetClippingRange(*self._clipping)
        state = camera_state(self.renderer)
        if state != self._drawn:
            self._drawn, self.count = state, 0
            self._look(self.seen)
        k = min(self.count, self.passes - 1)
        point = np.zeros(2) if self.seen.layer.sharp or self.paused else self._points[k]
        size = np.array(self.renderer.GetSize())
        shift = 2 * self._shifts[k] / size
        for zone in self._zones:
            zone.set_pass(point, shift, self._shifts[k])
            zone.bind()
        self.window.GetState().vtkglActiveTexture(_FIRST_UNIT + 15)

    def _look(self, seen: SeenScene) -> None:
        """Take over the camera: matrices, where the lens's edge runs, and which zones are in the picture."""
        found = frames(self.renderer, seen.head)
        width, height = found.size
        self._sum.clear(self.window.GetActualSize(), (*self.renderer.GetOrigin(), width, height))
        split = self.renderer.GetOrigin()[0] + width / 2 if seen.layer.split else -1.0
        visible = [True, False, False, False]
        if seen.edge is not None:
            left, low = self.renderer.GetOrigin()
            inside = bool(seen.edge.within(found.from_pixel @ [left + width / 2, low + height / 2, 1]))
            near = edge_in_view(seen.edge, found)
            through, around = inside or near, not inside or near or seen.layer.split
            parted = through and around and self._culls and not self._added
            visible = [through, around, parted, near]
        edge = seen.edge if visible[0] and visible[1] else None
        for zone, shown in zip(self._zones, visible, strict=True):
            zone.look(found, edge, split, parted=visible[2])
            for actor in zone.actors:
                actor.SetVisibility(shown)

    def _end(self, *_: Any) -> None:
        """After the renderer has drawn: add the pass, and show the mean."""
        if self.seen is None or self.paused:
            return
        if self.count < self.passes:
            self._sum.add()
            self.count += 1
        if self.displayed:
            self._sum.show(self.exposure)

    def _prove(self) -> None:
        """Draw once and find out whether the driver takes the shaders, of which VTK itself only prints the messages."""
        actors = [
            actor for zone in self._zones for actor in zone.actors if actor.GetMapper().GetInput().GetNumberOfPolys()
        ]
        drawn: list[bool] = []
        tags = [a.GetMapper().AddObserver("UpdateShaderEvent", lambda *_: drawn.append(True)) for a in actors]
        listener, printer = vtkStringOutputWindow(), vtkOutputWindow.GetInstance()
        vtkOutputWindow.SetInstance(listener)
        try:
            self.window.Render()
        finally:
            vtkOutputWindow.SetInstance(printer)
        for actor, tag in zip(actors, tags, strict=True):
            actor.GetMapper().RemoveObserver(tag)
        if sum(drawn) >= sum(actor.GetVisibility() for actor in actors):
            return
        if self.by_vertices or self.seen is None:
            message = " ".join(listener.GetOutput().split())[-300:]
            raise LensBenchError(f"the graphics driver refused the shader of the view: {message or 'no message'}")
        for zone in self._zones:
            self._fill(zone, [])
            zone.release()
        self.by_vertices = True
        self._zones = self._new_zones()
        self._set_scene(self.seen)
        self._prove()


def _best_sum(window: Any) -> CardSum | MemorySum:
    """The sum on the graphics card, or in memory where its driver cannot."""
    try:
        sums = CardSum(window)
        sums.clear((8, 8), (0, 0, 8, 8))
        return sums
    except LensBenchError:
        return MemorySum(window)
