"""Several designs side by side: one page, its pictures, and the measures of their zones as a table."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from ..compare import MAPS, Design, compare
from ..layers import LensMap, MapLayer
from ..optics.eye import Wearer
from ..optics.lens import Lens
from ..output import require_folder, to_json, write_file
from ..zones import Zones
from .facts import Fact, prescription_text, wearer_facts
from .html import Picture, picture_of, render
from .progress import Progress
from .tables import distance_text, map_numbers

FAR, BY_GAZE, NEAR = "∞", "by gaze", "near"
MEASURES = {
    "distance_width": ("Distance zone, width at the fitting point (mm)", FAR),
    "intermediate_width": ("Intermediate zone, width half-way down (mm)", BY_GAZE),
    "near_width": ("Near zone, width at the near reference point (mm)", NEAR),
    "distance_area": ("Distance zone, area (mm²)", FAR),
    "intermediate_area": ("Intermediate zone, area (mm²)", BY_GAZE),
    "near_area": ("Near zone, area (mm²)", NEAR),
    "corridor_width": ("Corridor, narrowest clear width (mm)", BY_GAZE),
    "corridor_y": ("… at y (mm)", BY_GAZE),
    "reach_of_addition": ("85 % of the addition, below the fitting point (mm)", BY_GAZE),
    "most_astigmatism": ("Greatest astigmatic error (D)", FAR),
    "most_astigmatism_at": ("… at x, y (mm)", FAR),
}  # label, and where the objects are for which it is taken, as in zones.Zones


def build_comparison(lenses: Sequence[Lens], wearer: Wearer, folder: Path, progress: Progress) -> None:
    """Write index.html (self-contained), the pictures, zones.csv and results.json of a comparison; the first lens is the
    reference.
    """
    require_folder(folder)
    progress.step("trace")
    designs = compare(lenses, wearer)
    progress.step("maps")
    pictures = comparison_pictures(designs)
    progress.step("page")
    contents: dict[str, bytes | str] = {picture.name: picture.png for picture in pictures.values()}
    contents["zones.csv"] = zones_csv(designs)
    contents["results.json"] = to_json(comparison_numbers(designs, wearer))
    contents["index.html"] = comparison_page(designs, wearer, pictures)
    for name, content in contents.items():
        write_file(folder / name, content)


def comparison_pictures(designs: Sequence[Design]) -> dict[str, Picture]:
    """All designs' maps of a quantity on one scale, all differences of a quantity on one, and the profiles."""
    from ..views.bands import shared_limits
    from ..views.comparison import profiles_figure
    from ..views.maps import map_figure

    pictures = {}
    for kind, first in (("maps", 0), ("differences", 1)):
        for k, layer in enumerate(MAPS):
            maps = [(n, design.lens, getattr(design, kind)[k]) for n, design in enumerate(designs) if n >= first]
            limits = shared_limits([lens_map for _, _, lens_map in maps])
            for n, lens, lens_map in maps:
                name = f"{kind}_{layer.quantity}_{n + 1}"
                figure = map_figure(lens, lens_map, limits=limits, subtitle=_subtitle(layer, kind, designs[0].lens))
                pictures[name] = picture_of(name, f"{lens.name}: {lens_map.label}", figure)
    figure = profiles_figure([d.lens for d in designs], [d.profile for d in designs])
    return pictures | {"profiles": picture_of("profiles", "Power along the main meridian of all designs", figure)}


def _subtitle(layer: MapLayer, kind: str, reference: Lens) -> str:
    text = distance_text(layer.distance)
    return f"less that of {reference.name}; {text}" if kind == "differences" else text


def comparison_page(designs: Sequence[Design], wearer: Wearer, pictures: dict[str, Picture]) -> str:
    """The comparison as one HTML page that needs no other file."""
    return render(
        "comparison.html",
        designs=designs,
        wearer=wearer,
        wearer_rows=wearer_facts(wearer),
        pictures=pictures,
        layers=MAPS,
        measures=measure_rows(designs, wearer),
        readings=reading_rows(designs),
        spreads=difference_rows(designs),
    )


def measure_rows(designs: Sequence[Design], wearer: Wearer) -> list[Fact]:
    """The measures of the zones, for objects where each is taken, one cell a design."""
    near = f"{wearer.wear.near_distance / 10:g} cm"
    return [
        Fact(name, label, [near if objects is NEAR else objects, *(_cell(getattr(d.zones, name)) for d in designs)])
        for name, (label, objects) in MEASURES.items()
    ]


def reading_rows(designs: Sequence[Design]) -> list[Fact]:
    """As-worn power at each reference point, one cell a design."""
    names = list(dict.fromkeys(reading.name for design in designs for reading in design.readings))
    rows = []
    for name in names:
        found = [next((r for r in design.readings if r.name == name), None) for design in designs]
        rows.append(Fact(name, name.replace("_", " "), [_power_cell(reading) for reading in found]))
    return rows


def _power_cell(reading: Any) -> str:
    from ..optics.conventions import power_matrix

    if reading is None or reading.status != "OK":
        return "–"
    return prescription_text(power_matrix(reading.sphere, reading.cylinder, reading.axis))


def difference_rows(designs: Sequence[Design]) -> list[Fact]:
    """Root mean square and greatest absolute difference of each map to the reference's, one cell a design."""
    return [
        Fact(
            layer.quantity,
            f"{designs[0].maps[k].label}, {distance_text(layer.distance)}: rms / greatest ({designs[0].maps[k].unit})",
            ["–", *(_spread(design.differences[k]) for design in designs[1:])],
        )
        for k, layer in enumerate(MAPS)
    ]


def _spread(lens_map: LensMap) -> str:
    values = lens_map.values[np.isfinite(lens_map.values)]
    return f"{np.sqrt(np.mean(values**2)):.2f} / {np.abs(values).max():.2f}" if values.size else "–"


def _cell(value: Any) -> str:
    if value is None:
        return "–"
    return ", ".join(f"{v:.1f}" for v in value) if isinstance(value, tuple) else f"{value:.2f}"


def zones_csv(designs: Sequence[Design]) -> str:
    """One row a design: name and the measures of its zones, as in zones.Zones (mm, mm2, D); empty where there is none."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    names = [f.name for f in fields(Zones) if f.name != "most_astigmatism_at"]
    writer.writerow(["lens", *names, "most_astigmatism_x", "most_astigmatism_y"])
    for design in designs:
        values = [getattr(design.zones, name) for name in names]
        numbers = ["" if v is None else f"{v:.6g}" for v in (*values, *design.zones.most_astigmatism_at)]
        writer.writerow([design.lens.name, *numbers])
    return out.getvalue()


def comparison_numbers(designs: Sequence[Design], wearer: Wearer) -> dict[str, Any]:
    """Everything that a comparison shows, for machines."""
    return {
        "format": "lensbench-comparison/1",
        "wearer": {fact.label: {"text": fact.text, "value": fact.value} for fact in wearer_facts(wearer)},
        "designs": [
            {
                "name": design.lens.name,
                "zones": asdict(design.zones),
                "reference_points": [asdict(reading) for reading in design.readings],
                "profile": asdict(design.profile),
                "maps": [map_numbers(m) for m in design.maps],
                "differences": [map_numbers(m) for m in design.differences],
            }
            for design in designs
        ],
    }
