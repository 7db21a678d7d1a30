"""Results as rows of numbers with units: CSV, and plain dictionaries for JSON."""

import csv
import io
import math
from dataclasses import fields
from typing import Any

import numpy as np

from ..layers import Deviation, DistortionGrid, EllipseSheet, LensMap, MapLayer, RealRays, RealRaysCheck, VoxelField
from ..optics.conoid import GazeConoids
from ..optics.conventions import Status
from ..optics.eye import Wearer
from ..optics.lens import Lens
from ..output import to_json
from ..pair import ConvergencePath
from ..quantities import QUANTITIES
from .facts import small_print, viewer_text


def distance_text(distance: float | str) -> str:
    """An object distance (mm) for a reader."""
    if distance == "model":
        return "objects at the wearer's distance for each gaze"
    if isinstance(distance, str):
        return "objects of the scene"
    if math.isinf(distance):
        return "objects at infinity"
    return f"objects at {distance / 1000:g} m" if distance >= 1000 else f"objects at {distance / 10:g} cm"


def map_words(lens: Lens, wearer: Wearer, layer: MapLayer) -> dict[str, Any]:
    """What a map's picture says beside its title: subtitle (object distance) and notes (who looks), where these matter."""
    about = QUANTITIES[layer.quantity].about
    notes = () if about else small_print(lens, wearer, layer.accommodation)
    return {"subtitle": about or distance_text(layer.distance), "notes": notes}


def map_numbers(lens_map: LensMap) -> dict[str, Any]:
    """Quantity, unit, coordinates (mm), values and status of a map, ready for JSON."""
    return {f.name: getattr(lens_map, f.name) for f in fields(lens_map)}


def map_csv(lens_map: LensMap) -> str:
    """x_mm, y_mm, the quantity with its unit, status: one line a sample within the outline."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["x_mm", "y_mm", lens_map.column, "status"])
    for j, i in np.argwhere(lens_map.status != Status.OUTSIDE_OUTLINE):
        value, status = lens_map.values[j, i], Status(lens_map.status[j, i])
        writer.writerow([f"{lens_map.x[i]:.4f}", f"{lens_map.y[j]:.4f}", f"{value:.6g}", status.name])
    return out.getvalue()


def deviation_numbers(found: Deviation, tolerance: float) -> dict[str, Any]:
    """Of each difference (D): count, mean, rms, greatest amount and where (mm), part within the tolerance; and the maps."""
    numbers: dict[str, Any] = {"by": found.layer.by, "tolerance_D": tolerance, "x_mm": found.x, "y_mm": found.y}
    for name, values in (("mean_power", found.mean), ("astigmatic", found.astigmatic)):
        known = values[np.isfinite(values)]
        if not known.size:
            continue
        j, i = np.unravel_index(np.nanargmax(np.abs(values)), values.shape)
        numbers[name] = {
            "points": known.size,
            "mean_D": known.mean(),
            "rms_D": np.sqrt(np.mean(known**2)),
            "greatest_D": np.abs(known).max(),
            "greatest_at_mm": [found.x[i], found.y[j]],
            "within_tolerance": np.mean(np.abs(known) <= tolerance),
            "difference_D": values,
        }
    return numbers


def deviation_csv(found: Deviation) -> str:
    """x_mm, y_mm, measured less designed mean power (D), astigmatic difference (D): one line a point with a value."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["x_mm", "y_mm", "mean_power_difference_D", "astigmatic_difference_D"])
    for j, i in np.argwhere(np.isfinite(found.mean) | np.isfinite(found.astigmatic)):
        values = f"{found.mean[j, i]:.6g}", f"{found.astigmatic[j, i]:.6g}"
        writer.writerow([f"{found.x[i]:.4f}", f"{found.y[j]:.4f}", *values])
    return out.getvalue()


BLURRED = 1.0  # arcmin


def real_rays_rows(found: RealRays) -> list[dict[str, Any]]:
    """One dictionary a distance: how far the first order is from real rays, medians and 90th percentiles over the gazes.

    blur: its rms diameter by real rays, deviation: of the first order from it, arcmin; relative_deviation: per cent of the
    blur, over the gazes whose blur is more than BLURRED; higher_order_rms: um.
    """
    return [_real_rays_row(check) for check in found.checks]


def _real_rays_row(check: RealRaysCheck) -> dict[str, Any]:
    known = np.isfinite(check.real_rays)
    blur, off = check.real_rays[known], np.abs(check.deviation[known])
    blurred = blur > BLURRED
    spreads = {
        "blur": blur,
        "deviation": off,
        "relative_deviation": 100 * off[blurred] / blur[blurred],
        "higher_order_rms": check.higher_order_rms[known],
    }
    middle = {
        f"{name}_{word}": float(np.percentile(values, share)) if values.size else math.nan
        for name, values in spreads.items()
        for word, share in (("median", 50), ("p90", 90))
    }
    return {"objects": distance_text(check.distance), "gazes": blur.size, "blurred": int(blurred.sum()), **middle}


def distortion_numbers(grid: DistortionGrid) -> dict[str, Any]:
    """The crossings of a chart's lines: tangents of their true and of their seen directions, and status; ready for JSON."""
    at = slice(None, None, grid.layer.fineness)
    return {
        "depth": grid.layer.depth,
        "object": grid.object[at, at],
        "apparent": grid.apparent[at, at],
        "status": grid.status[at, at],
    }


def distortion_csv(grid: DistortionGrid) -> str:
    """The crossings of a chart's lines, one a line: tangents of their true and of their seen directions, and status."""
    numbers = distortion_numbers(grid)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["object_x", "object_y", "apparent_x", "apparent_y", "status"])
    at, seen = numbers["object"].reshape(-1, 2), numbers["apparent"].reshape(-1, 2)
    for true, apparent, status in zip(at, seen, numbers["status"].ravel(), strict=True):
        writer.writerow([*(f"{value:.6g}" for value in (*true, *apparent)), Status(status).name])
    return out.getvalue()


def path_csv(path: ConvergencePath) -> str:
    """The convergence path, one line a lowering of the gaze."""
    columns = {
        "lowering_deg": path.lowering,
        "distance_mm": path.distance,
        **{
            f"{side}_{name}_mm": getattr(getattr(path, side), name)
            for side in ("right", "left")
            for name in ("x", "y", "off_meridian")
        },
        "vertical_imbalance_cm/m": path.vertical_imbalance,
        "induced_vergence_cm/m": path.induced_vergence,
    }
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([f"{value:.6g}" for value in row] for row in zip(*columns.values(), strict=True))
    return out.getvalue()


def ellipse_rows(sheets: tuple[EllipseSheet, ...]) -> list[dict[str, Any]]:
    """One dictionary an ellipse: depth, centre, semi-axes (mm), orientation (degrees), accommodation (D), status."""
    return [
        {
            "depth_mm": sheet.depth,
            "x_mm": sheet.centre[k, 0],
            "y_mm": sheet.centre[k, 1],
            "z_mm": sheet.centre[k, 2],
            "semi_major_mm": sheet.semi_major[k],
            "semi_minor_mm": sheet.semi_minor[k],
            "orientation_deg": np.degrees(sheet.orientation[k]),
            "accommodation_D": sheet.accommodation[k],
            "status": Status(sheet.status[k]).name,
        }
        for sheet in sheets
        for k in range(len(sheet.status))
    ]


def ellipses_csv(sheets: tuple[EllipseSheet, ...]) -> str:
    """The rows of `ellipse_rows` as CSV."""
    rows = ellipse_rows(sheets)
    out = io.StringIO()
    writer = csv.DictWriter(out, rows[0], lineterminator="\n")
    writer.writeheader()
    writer.writerows({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)
    return out.getvalue()


def voxels_about(lens: Lens, wearer: Wearer, voxels: VoxelField) -> dict[str, Any]:
    """What a blur field says of itself: whose it is, the camera that its frustum belongs to, units."""
    layer = voxels.layer
    return {
        "lens": lens.name,
        "seen_by": viewer_text(wearer, layer.accommodation),
        "exaggeration": layer.exaggeration,
        "camera": {
            "position_mm": wearer.centre_of_rotation,
            "ahead": [0, 0, 1],
            "up": [0, 1, 0],
            "field_of_view_deg": 2 * math.degrees(layer.half_angle),
            "near_mm": layer.near + wearer.eye.centre_of_rotation,
            "far_mm": layer.far + wearer.eye.centre_of_rotation,
        },
        "frame": "wear frame, mm: x to the wearer's left, y up, z ahead, the back vertex at 0",
        "units": {
            "blur": "mm, across the outgoing ray, by unit vector of the pupil: M11 M12 M21 M22",
            "ndc": "NDC of the picture (x to the wearer's left, y up, -1 to 1), by unit vector of the pupil; -x to the right",
            "u, v": "tangent of the gaze",
            "depth": "mm straight ahead from the cornea",
        },
    }


def voxels_npz(voxels: VoxelField, about: dict[str, Any]) -> bytes:
    """The blur field as a compressed .npz: blur, u, v, depth, status (and ndc) as in VoxelField; about: JSON text."""
    buffer = io.BytesIO()
    arrays = {f.name: getattr(voxels, f.name) for f in fields(voxels) if f.name != "layer"}
    arrays = {name: array for name, array in arrays.items() if array is not None}
    np.savez_compressed(buffer, about=to_json(about), **arrays)
    return buffer.getvalue()


def conoid_numbers(found: GazeConoids) -> dict[str, Any]:
    """The object's distance and, of each state of accommodation, focal lines, circle of least confusion, ellipse there (mm)."""
    return {"distance_mm": found.distance} | {
        name: {
            "accommodation_D": conoid.accommodation,
            "focal_lines_mm": conoid.focal_lines,
            "least_confusion_mm": conoid.least_confusion,
            "least_confusion_diameter_mm": 2 * conoid.eoc(conoid.least_confusion).semi_major,
            "semi_major_mm": conoid.eoc(found.distance).semi_major,
            "semi_minor_mm": conoid.eoc(found.distance).semi_minor,
            "orientation_deg": np.degrees(conoid.eoc(found.distance).orientation),
        }
        for name, conoid in found.states.items()
    }


def conoid_csv(found: GazeConoids) -> str:
    """Signed semi-axes (mm) of the three states along the ray: one line a distance from the front surface."""
    reach = found.reach()
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["distance_mm", *(f"{name}_axis_{k}_mm" for name in found.states for k in (1, 2))])
    distance = np.linspace(0.0, reach, 201)
    axes = [axis for conoid in found.states.values() for axis in conoid.signed_axes(distance)]
    writer.writerows([f"{value:.6g}" for value in row] for row in np.stack([distance, *axes], axis=1))
    return out.getvalue()
