"""What there is to say in words about lenses, wearers and scenes: labels, values and units, for `check` and for the report."""

from dataclasses import asdict
from typing import Any, NamedTuple

import numpy as np

from ..formats.surface_data import Reading
from ..layers import SeenScene
from ..optics.conventions import Floats, astigmatism, mean_power, sphere_cylinder_axis
from ..optics.eye import Wear, Wearer
from ..optics.field import Accommodation
from ..optics.lens import Lens, Order
from ..optics.lensmeter import surface_power
from ..scenes.facts import scene_facts
from ..scenes.scene import Scene
from ..seen import middle_distance


class Fact(NamedTuple):
    """label, value as text with its unit, and the numbers behind it (JSON-ready, units named in the label or value)."""

    label: str
    text: str
    value: object


def prescription_text(matrix: Floats) -> str:
    """A power matrix (2, 2) in D as written in a prescription: sphere / cylinder x axis (degrees, 1 to 180)."""
    sphere, cylinder, axis = (float(v) for v in sphere_cylinder_axis(matrix))
    if abs(cylinder) < 0.005:
        return f"{round(sphere, 2) + 0.0:+.2f}"
    return f"{round(sphere, 2) + 0.0:+.2f} / {cylinder:+.2f} x {round(axis) or 180}"


def order_text(order: Order) -> str:
    """An order, or a verification power, in words."""
    addition = f", addition {order.addition:.2f} D" if order.addition else ""
    prism = f", prism {order.prism:.2f} cm/m base {order.prism_base:.0f}°" if order.prism else ""
    return f"{prescription_text(order.power())} D{addition}{prism}"


def wear_text(wear: Wear) -> str:
    """What of a position of wear decides the power, in words."""
    panto, face = np.degrees([wear.pantoscopic_angle, wear.face_form_angle])
    return (
        f"vertex distance {wear.vertex_distance:g} mm, pantoscopic angle {panto:g}°, face-form angle {face:g}°, "
        f"near distance {wear.near_distance:g} mm"
    )


def viewer_text(wearer: Wearer, rule: Accommodation) -> str:
    """Who looks, in a line for a picture: refraction, amplitude and pupil of the eye, and how it accommodates."""
    eye = wearer.eye
    power, amplitude = prescription_text(eye.refraction), f"{eye.accommodation:.2f}"
    focus = f"accommodation rule {rule}" if isinstance(rule, str) else f"accommodating {np.mean(rule):.2f} D"
    return f"eye {power} D, amplitude {amplitude} D, pupil {eye.pupil_diameter:.3g} mm, {focus}"


def small_print(lens: Lens | None, wearer: Wearer, rule: Accommodation) -> tuple[str, ...]:
    """What a picture's small print says of who looks, a text a line: the wearer, and a lens ordered for another one."""
    name = f"{wearer.name}: " if wearer.name else ""
    doubt = misfit(lens, wearer) if lens else ""
    return (name + viewer_text(wearer, rule), *([doubt] if doubt else []))


def view_text(seen: SeenScene) -> tuple[str, ...]:
    """What a simulated view shows, a text a line: scene and lens, how far away its middle is, and who looks."""
    layer = seen.layer
    through = f"through {seen.lens.name or 'the lens'}" if seen.lens else "without a lens"
    sharp = ", nothing blurred" if layer.sharp else ""
    away = middle_distance(seen)
    middle = f", {away_text(away)} from the eye" if np.isfinite(away) else ""
    where = f"{seen.scene.name.capitalize()}: {gaze_text(layer.azimuth, layer.elevation)} in the middle{middle}"
    wide = f"{np.degrees(2 * layer.half_width):.0f}° wide"
    return (f"{where}, {wide}; {through}{sharp}", *small_print(seen.lens, seen.wearer, layer.accommodation))


def away_text(distance: float) -> str:
    """How far away something is (mm), for a reader."""
    return f"{distance / 10:.0f} cm" if distance < 995 else f"{distance / 1000:.1f} m"


RULES = {
    "retina": "least blur on the retina",
    "object": "least ellipse at the object",
    "paper": "signed axes that cancel",
}


def rule_text(rule: Accommodation) -> str:
    """For what, or by how much, an eye accommodates."""
    return f"for the {RULES[rule]}" if isinstance(rule, str) else f"by {np.mean(rule):.2f} D"


def gaze_text(azimuth: float, elevation: float) -> str:
    """A direction of gaze (rad) in words."""
    left, up = np.degrees([azimuth, elevation]).round()
    return (
        f"gaze {abs(up):.0f}° {'down' if up < 0 else 'up'}, {abs(left):.0f}° to the {'right' if left < 0 else 'left'}"
    )


def misfit(lens: Lens, wearer: Wearer) -> str:
    """A sentence where the ordered power and the wearer's prescription differ by more than 0.25 D; else nothing."""
    if lens.ordered is None:
        return ""
    gap = lens.ordered.power() - wearer.prescription
    if max(abs(mean_power(gap)), astigmatism(gap)) <= 0.25:
        return ""
    return (
        f"{lens.name} was ordered as {prescription_text(lens.ordered.power())} D, but this wearer's prescription at its vertex "
        f"is {prescription_text(wearer.prescription)} D."
    )


def file_facts(found: Any, reading: Reading | None = None) -> list[Fact]:
    """What a file holds: a lens, a wearer, one surface (read as told), or whatever has facts() of its own."""
    if isinstance(found, Lens):
        return [Fact("File", "a lens", "lens"), *lens_facts(found)]
    if isinstance(found, Wearer):
        return [Fact("File", "a wearer", "wearer"), *wearer_facts(found)]
    if isinstance(found, Scene):
        return [Fact("File", "a scene", "scene"), *_scene_facts(found)]
    if hasattr(found, "facts"):
        return [Fact(*fact) for fact in found.facts()]
    what = f"a surface: side {found.side or '?'}, face {found.face or '?'}"
    fitted = found.fitted(reading or Reading())
    return [Fact("File", what, "surface"), *(Fact(*fact) for fact in fitted.facts)]


def _scene_facts(scene: Scene) -> list[Fact]:
    """The scene: size of its mesh, and its looks with distances from the cornea (mm) and directions (degrees)."""
    found = scene_facts(scene)
    facts = [
        Fact("Name", found["name"], found["name"]),
        Fact("Triangles", f"{found['triangles']}, edges up to {found['widest_edge']:.1f} degrees", found["triangles"]),
    ]
    for name, k in found["looks"].items():
        text = f"{k['distance']:.0f} mm away, elevation {k['elevation']:+.1f}, azimuth {k['azimuth']:+.1f} degrees"
        facts.append(Fact(f"Look {name}", text, k))
    return facts


def lens_facts(lens: Lens) -> list[Fact]:
    """The lens: material, surfaces, thicknesses (mm), weight (g), outline (mm), order."""
    m, edge = lens.material, lens.minimum_edge_thickness()
    x, y = lens.outline.points()
    thickest = float(np.nanmax(lens.thickness(x, y)))
    x0, x1, y0, y1 = lens.outline.box
    weight = lens.weight()
    facts = [
        Fact("Name", lens.name, lens.name),
        *([Fact("Understood", lens.note, lens.note)] if lens.note else []),
        Fact("Side", {"R": "right", "L": "left"}[lens.side], lens.side),
        Fact(
            "Material",
            f"{m.name}: n_{lens.wavelength} = {lens.index:g}, Abbe number V_d = {m.abbe:g}, {m.density:g} g/cm³",
            {"name": m.name, "n_d": m.n_d, "n_e": m.n_e, "abbe": m.abbe, "density_g_cm3": m.density},
        ),
        *_surface_facts(lens),
        Fact("Centre thickness", f"{lens.centre_thickness:.2f} mm", lens.centre_thickness),
        Fact(
            "Minimum edge thickness",
            f"{edge.thickness:.2f} mm at x = {edge.x:.1f}, y = {edge.y:.1f} mm",
            {"mm": edge.thickness, "x_mm": edge.x, "y_mm": edge.y},
        ),
        Fact("Maximum edge thickness", f"{thickest:.2f} mm", thickest),
        Fact("Weight", f"{weight:.1f} g", weight),
        Fact(
            "Outline",
            f"{x1 - x0:.1f} x {y1 - y0:.1f} mm, x {x0:.1f} to {x1:.1f}, y {y0:.1f} to {y1:.1f}",
            [x0, x1, y0, y1],
        ),
        Fact(
            "Reference points",
            "; ".join(f"{name.replace('_', ' ')} {px:g}, {py:g} mm" for name, (px, py) in lens.points.named().items()),
            lens.points.named(),
        ),
    ]
    return [
        *facts,
        *(
            Fact(label, order_text(power), asdict(power))
            for label, power in (("Ordered power", lens.ordered), ("Verification power", lens.verification_power))
            if power is not None
        ),
    ]


def _surface_facts(lens: Lens) -> list[Fact]:
    """Both surfaces in words, and their mean surface power (D) at the distance reference point or, without one, at (0, 0)."""
    x, y = lens.points.distance_reference_point or (0.0, 0.0)
    facts = []
    for name, surface, sign in (("Front surface", lens.front, 1.0), ("Back surface", lens.back, -1.0)):
        power = sign * float(mean_power(surface_power(surface, x, y, lens.index)))
        text = f"{surface.describe()}; surface power {power:+.2f} D at x = {x:g}, y = {y:g} mm"
        facts.append(Fact(name, text, {"described": surface.describe(), "mean_surface_power_D": power}))
    return facts


def wearer_facts(wearer: Wearer) -> list[Fact]:
    """The wearer: refraction and accommodation (D), pupil and distances (mm), angles (degrees)."""
    eye, wear = wearer.eye, wearer.wear
    panto, face = float(np.degrees(wear.pantoscopic_angle)), float(np.degrees(wear.face_form_angle))
    upright = float(np.degrees(wear.pantoscopic_angle_in_vertical_plane))
    facts = [Fact("Name", wearer.name, wearer.name)]
    if wearer.age is not None:
        facts.append(Fact("Age", f"{wearer.age:g} years", wearer.age))
    return [
        *facts,
        Fact(
            "Refraction",
            f"{prescription_text(eye.refraction)} D, {eye.refraction_vertex_distance:g} mm before the cornea",
            eye.refraction,
        ),
        Fact("Refraction at the pupil", prescription_text(eye.pupil_refraction) + " D", eye.pupil_refraction),
        Fact("Amplitude of accommodation", f"{eye.accommodation:.2f} D", eye.accommodation),
        Fact("Pupil diameter", f"{eye.pupil_diameter:.2f} mm", eye.pupil_diameter),
        Fact("Vertex distance", f"{wear.vertex_distance:g} mm", wear.vertex_distance),
        Fact(
            "Pantoscopic angle",
            f"{panto:.1f}°" + (f" against the horizontal plane, {upright:.2f}° in the vertical plane" if face else ""),
            panto,
        ),
        Fact("Face-form angle", f"{face:.1f}°", face),
        Fact("Centre of rotation", f"{eye.centre_of_rotation:g} mm behind the cornea", eye.centre_of_rotation),
        Fact("Entrance pupil", f"{eye.entrance_pupil:g} mm behind the cornea", eye.entrance_pupil),
        Fact("Decentration", "{:g}, {:g} mm".format(*wear.decentration), wear.decentration),
        Fact("Monocular pupillary distance", f"{wear.pupillary_distance:g} mm", wear.pupillary_distance),
        Fact("Near distance", f"{wear.near_distance:g} mm from the cornea", wear.near_distance),
    ]
