"""From a lens and a wearer to a folder with index.html (self-contained), the pictures and results.json."""

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .. import __version__
from ..layers import (
    DistortionGrid,
    DistortionLayer,
    EllipseLayer,
    EllipseSheet,
    LensMap,
    MapLayer,
    PointReading,
    PointsLayer,
    Profile,
    ProfileLayer,
    RealRays,
    RealRaysLayer,
    Request,
    VerificationLayer,
    ViewLayer,
)
from ..optics.conventions import VERSION, Status
from ..optics.eye import Wearer
from ..optics.field import Accommodation
from ..optics.lens import Lens
from ..optics.tolerances import Verification
from ..output import require_folder, to_json, write_file
from ..quantities import QUANTITIES
from ..scenes.scene import Scene
from ..workbench import look, run
from .facts import Fact, gaze_text, lens_facts, misfit, rule_text, wearer_facts
from .html import Picture, picture_of, render
from .progress import Progress
from .readings import reading_groups
from .tables import BLURRED, distance_text, distortion_numbers, map_numbers, real_rays_rows
from .verification import row_of, sentences

DEFAULT_DISTANCES = (math.inf, 780.0, 400.0)
EYES = {"lens": "With the lens", "naked": "Without the lens", "pinhole": "With the lens, through a pinhole"}
PASSES, PINHOLE_PASSES = 32, 8
MAPS = (
    "mean_error", "astigmatic_error", "prism", "thickness",
    "magnification", "magnification_anisotropy", "skew", "swim", "transverse_chromatic",
)  # fmt: skip
MODES = tuple(
    tuple(f"{mode}{name}" for mode in ("", "lensmeter_", "surface_")) for name in ("mean_power", "astigmatism")
)
UNITS = {
    "x": "mm", "centre": "mm", "y": "mm", "depth": "mm", "distance": "mm", "semi_major": "mm", "semi_minor": "mm",
    "azimuth": "degrees, towards the wearer's left", "elevation": "degrees, upwards", "axis": "degrees TABO",
    "prism_base": "degrees TABO, 0 to 360", "prism": "cm/m", "orientation": "rad",
    "sphere": "D", "cylinder": "D", "mean_power": "D", "least_power": "D", "greatest_power": "D", "astigmatism": "D",
    "mean_error": "D", "astigmatic_error": "D", "accommodation": "D", "prism_error": "cm/m", "exaggeration": "1",
    "lensmeter_sphere": "D", "lensmeter_cylinder": "D", "lensmeter_axis": "degrees TABO", "lensmeter_prism": "cm/m",
    "lensmeter_prism_base": "degrees TABO, 0 to 360", "blur_median": "arcmin", "blur_p90": "arcmin",
    "deviation_median": "arcmin", "deviation_p90": "arcmin", "relative_deviation_median": "%",
    "relative_deviation_p90": "%", "higher_order_rms_median": "um", "higher_order_rms_p90": "um",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Terms:
    """What a report is asked for. distances: of the objects of the defocus maps, depths: of the ellipses of confusion, mm;
    accommodation: the rule, or D.
    """

    distances: tuple[float, ...] = DEFAULT_DISTANCES
    depths: tuple[float, ...] = EllipseLayer().depths
    accommodation: Accommodation = "retina"


@dataclass(frozen=True, slots=True)
class Findings:
    """All numbers of a report, and what they were asked for."""

    terms: Terms
    lens: list[Fact]
    wearer: list[Fact]
    readings: tuple[PointReading, ...]
    verification: Verification | None
    profile: Profile
    maps: dict[str, LensMap]
    defocus: dict[float | str, LensMap]
    ellipses: tuple[EllipseSheet, ...]
    looks: dict[str, tuple[float, float]]
    real_rays: RealRays
    distortion: DistortionGrid


def build_report(
    lens: Lens,
    wearer: Wearer,
    folder: Path,
    terms: Terms,
    progress: Progress,
    scene: Scene | None = None,
) -> None:
    """Write the report of a lens as this wearer wears it.

    scene: what the wearer looks at; None: the built-in room.
    """
    from ..scenes.builtin import load_scene

    require_folder(folder)
    progress.step("scene")
    scene = scene or load_scene("room")
    progress.step("trace")
    findings = find(lens, wearer, terms, scene)
    progress.step("maps")
    pictures = flat_pictures(lens, findings)
    progress.step("lens and ellipses in space")
    pictures |= spatial_pictures(lens, wearer, findings)
    pictures |= view_pictures(lens, wearer, scene, findings, progress)
    progress.step("page")
    contents: dict[str, bytes | str] = {picture.name: picture.png for picture in pictures.values()}
    contents["results.json"] = to_json(results(lens, wearer, findings))
    contents["index.html"] = page(lens, wearer, findings, pictures)
    for name, content in contents.items():
        write_file(folder / name, content)


def find(lens: Lens, wearer: Wearer, terms: Terms, scene: Any) -> Findings:
    """Run every request of the report."""

    def ask(layer: Any) -> Any:
        return run(Request(lens, wearer, layer, scene))

    names = [*MAPS, *(name for modes in MODES for name in modes)]
    distances, rule = (*terms.distances, "model", "scene"), terms.accommodation
    return Findings(
        terms,
        lens_facts(lens),
        wearer_facts(wearer),
        ask(PointsLayer()),
        ask(VerificationLayer()),
        ask(ProfileLayer()),
        {name: ask(MapLayer(name)) for name in names},
        {d: ask(MapLayer("defocus", d, rule)) for d in distances},
        ask(EllipseLayer(terms.depths, accommodation=rule)),
        {name: look(name, lens, wearer, scene) for name in scene.looks},
        ask(RealRaysLayer(distances, accommodation=rule)),
        ask(DistortionLayer()),
    )


def flat_pictures(lens: Lens, findings: Findings) -> dict[str, Picture]:
    """Maps, profile and sections as flat figures."""
    from ..views.bands import shared_limits
    from ..views.distortion import distortion_figure
    from ..views.maps import map_figure, profile_figure, section_figure

    scale = {name: shared_limits([findings.maps[n] for n in modes]) for modes in MODES for name in modes}
    pictures = {
        name: picture_of(
            name, lens_map.label, map_figure(lens, lens_map, limits=scale.get(name), subtitle=_map_subtitle(name))
        )
        for name, lens_map in findings.maps.items()
    }
    pictures["profile"] = picture_of(
        "profile",
        "Power profile along the main meridian",
        profile_figure(lens, findings.profile, "through the fitting and near reference points, objects at infinity"),
    )
    pictures["section"] = picture_of("section", "Vertical and horizontal section", section_figure(lens))
    seen = distortion_figure(lens, findings.distortion, "chart straight ahead, far away")
    pictures["distortion"] = picture_of("distortion", "Distortion of a chart of upright lines", seen)
    return pictures | _real_rays_pictures(lens, findings.real_rays)


def _real_rays_pictures(lens: Lens, found: RealRays) -> dict[str, Picture]:
    from ..views.real_rays import real_rays_figure, spots_figure

    compared = real_rays_figure(lens, found, [distance_text(check.distance) for check in found.checks])
    pictures = {"real_rays": picture_of("real_rays", "First order against real rays", compared)}
    if found.spots:
        spots = spots_figure(lens, found.spots, [distance_text(float(f"{s.distance:.3g}")) for s in found.spots])
        pictures["spots"] = picture_of("spots", "Spots and ellipses of confusion", spots)
    return pictures


def _map_subtitle(name: str) -> str:
    if name.endswith("error"):
        return "less the wearer's refraction; objects at infinity"
    return QUANTITIES[name].about or "objects at infinity"


def spatial_pictures(lens: Lens, wearer: Wearer, findings: Findings) -> dict[str, Picture]:
    """Defocus maps on the lens in space, all on one scale, and the ellipses of confusion."""
    from ..views.bands import shared_limits
    from ..views.ellipses import ellipse_figure, ellipse_stack
    from ..views.lens3d import map_on_lens

    limits = shared_limits(list(findings.defocus.values()))
    pictures = {}
    for distance, lens_map in findings.defocus.items():
        text = distance_text(distance)
        name = f"defocus_{distance if isinstance(distance, str) else f'{distance:g}'}"
        picture = map_on_lens(lens, wearer, lens_map, limits=limits, subtitle=text)
        pictures[name] = picture_of(name, f"Defocus map, {text}", picture)
    layers = ellipse_figure(lens, wearer, findings.ellipses)
    pictures["ellipses"] = picture_of("ellipses", "Ellipses of confusion", layers)
    stack = ellipse_stack(lens, wearer, findings.ellipses)
    pictures["ellipses_in_space"] = picture_of("ellipses_in_space", "Ellipses of confusion in space", stack)
    return pictures


def view_pictures(lens: Lens, wearer: Wearer, scene: Any, findings: Findings, progress: Progress) -> dict[str, Picture]:
    """The scene by each of its looks: with the lens, without it, and sharp through a pinhole."""
    from ..views.jitter import Studio, side_by_side

    pictures, rule = {}, findings.terms.accommodation
    with Studio() as studio:
        for name, gaze in findings.looks.items():
            progress.step(f"view {name}")
            seen = {eye: run(Request(lens, wearer, ViewLayer(eye, *gaze, accommodation=rule), scene)) for eye in EYES}
            drawn = {
                eye: studio.picture(view, PINHOLE_PASSES if view.layer.sharp else PASSES) for eye, view in seen.items()
            }
            caption = f"Looking {name}: {gaze_text(*gaze)} at the centre, 50° wide"
            strip = side_by_side([(EYES[eye], drawn[eye]) for eye in EYES], caption)
            pictures[f"view_{name}"] = picture_of(f"view_{name}", caption, strip)
    return pictures


def results(lens: Lens, wearer: Wearer, findings: Findings) -> dict[str, Any]:
    """Everything that the report shows as numbers, for machines."""
    from ..views.ellipses import fitting_exaggeration

    exaggeration = fitting_exaggeration(findings.ellipses)
    return {
        "format": "lensbench-results/1",
        "lensbench": __version__,
        "conventions": VERSION,
        "units": UNITS,
        "status": {s.name: s.value for s in Status},
        "accommodation_rule": findings.terms.accommodation,
        "lens": {f.label: {"text": f.text, "value": f.value} for f in findings.lens},
        "wearer": {f.label: {"text": f.text, "value": f.value} for f in findings.wearer},
        "reference_points": [asdict(r) for r in findings.readings],
        "verification": asdict(findings.verification) if findings.verification else None,
        "profile": asdict(findings.profile),
        "maps": {name: map_numbers(m) for name, m in findings.maps.items()},
        "defocus": {distance_text(d): map_numbers(m) for d, m in findings.defocus.items()},
        "ellipses": [
            {k: v for k, v in asdict(sheet).items() if k != "spokes"} | {"exaggeration": exaggeration}
            for sheet in findings.ellipses
        ],
        "distortion": distortion_numbers(findings.distortion),
        "first_order_against_real_rays": real_rays_rows(findings.real_rays),
        "views": {
            name: dict(zip(("azimuth", "elevation"), np.degrees(gaze), strict=True))
            for name, gaze in findings.looks.items()
        },
    }


def page(lens: Lens, wearer: Wearer, findings: Findings, pictures: dict[str, Picture]) -> str:
    """The report as one HTML page that needs no other file."""
    return render(
        "template.html",
        lens=lens,
        wearer=wearer,
        findings=findings,
        pictures=pictures,
        row_of=row_of,
        sentences=sentences,
        rule_text=rule_text,
        looks=findings.looks,
        real_rays=real_rays_rows(findings.real_rays),
        blurred=BLURRED,
        misfit=misfit(lens, wearer),
        readings=reading_groups(lens, findings.readings),
        failed=_failed(findings.maps["mean_power"]),
    )


def _failed(lens_map: LensMap) -> str:
    """Which share of a map's rays failed, in words; empty when none did."""
    inside = lens_map.status[lens_map.status != Status.OUTSIDE_OUTLINE]
    counts = {s: int(np.sum(inside == s)) for s in Status if s != Status.OK and np.any(inside == s)}
    return ", ".join(f"{n / inside.size:.1%} {s.name.lower().replace('_', ' ')}" for s, n in counts.items())
