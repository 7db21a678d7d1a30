"""Flat pictures of a lens: maps with bands and isolines, power profiles, cross-sections. Matplotlib only, no GL.

Every map is seen from in front of the wearer: +x (the wearer's left) to the right of the picture, +y up.
"""

from collections.abc import Iterable, Sequence
from io import BytesIO
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray
from PIL import Image

from ..errors import InputError
from ..layers import LensMap, Profile
from ..optics.conventions import Floats, mean_power
from ..optics.lens import Lens
from ..output import write_file
from .bands import Bands, extended, map_bands

INK, QUIET = "#202428", "#667078"
EYE = {"R": "right", "L": "left"}
FEW = 60  # points whose values can be written beside them
LINE = 0.16  # inches from line to line of small print
# ---- maps ----


def map_figure(
    lens: Lens,
    lens_map: LensMap,
    step: float | None = None,
    limits: tuple[float, float] | None = None,
    subtitle: str = "",
    notes: Sequence[str] = (),
) -> Figure:
    """Bands and labelled isolines of a map within the lens's outline, with reference marks and colour bar.

    step, limits: in the map's unit, else what suits the quantity. subtitle: a line under the title (object distance).
    notes: small print (who looks).
    """
    figure, axes = _lens_axes(lens, notes)
    titles(figure, axes.get_position().x0, lens_map.label, lens.name, subtitle)
    if np.isfinite(lens_map.values).any():
        bands = map_bands(lens, lens_map, step, limits)
        if scattered(lens_map.values):
            _draw_points(axes, lens_map, bands)
        else:
            _draw_bands(axes, lens, lens_map, bands)
        box = axes.get_position()
        bar = figure.add_axes((box.x1 + 0.03, box.y0 + 0.08 * box.height, 0.025, 0.84 * box.height))
        colour_bar(bar, bands, lens_map.unit)
    else:
        centre = lens.outline.centre
        axes.text(*centre, f"no ray passes: there is no {lens_map.label.lower()} to show", ha="center", color=INK)
    axes.add_patch(Polygon(np.transpose(lens.outline.points()), fill=False, edgecolor=INK, linewidth=1.4, zorder=4))
    draw_marks(axes, lens)
    bottom = (0.34 + LINE * len(wrapped(figure.get_figwidth(), notes))) / figure.get_figheight()
    figure.legend(
        loc="lower center", bbox_to_anchor=(0.5, bottom), ncols=4, fontsize=8, frameon=False, handletextpad=0.3
    )
    return figure


def blank_figure(width: float, height: float) -> Figure:
    """An empty white figure of a size in inches of 100 pixels, with a canvas of its own."""
    figure = Figure((width, height), dpi=100, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def place(figure: Figure, *box: float) -> Axes:
    """Axes at (left, bottom, width, height) in inches."""
    return figure.add_axes(tuple(np.array(box) / np.tile(figure.get_size_inches(), 2)))


def small_print(figure: Figure, *texts: str) -> None:
    """Lines at the lower right corner; the last text is the lowest."""
    width, height = figure.get_size_inches()
    for k, line in enumerate(reversed(wrapped(width, texts))):
        up = (0.12 + LINE * k) / height
        figure.text(1 - 0.15 / width, up, line, ha="right", size=8, color=QUIET, parse_math=False)


def wrapped(width: float, texts: Iterable[str]) -> list[str]:
    """Small print in lines that fit a figure so many inches wide, each text on lines of its own."""
    return [line for text in texts for line in wrap(text, int(16.5 * width))]


def _lens_axes(lens: Lens, notes: Sequence[str]) -> tuple[Figure, Axes]:
    """A figure about 900 pixels wide with equal axes (mm) around the lens's outline, and notes in small print."""
    x0, x1, y0, y1 = lens.outline.box
    width, height = x1 - x0 + 3, y1 - y0 + 3
    scale = min(6.5 / width, 7.0 / height)
    across, up = scale * width, scale * height
    wide = 2.4 + max(across, 6.2)
    low = 1.05 + LINE * len(wrapped(wide, notes))
    figure = blank_figure(wide, low + up + 0.8)
    axes = place(figure, 0.8, low, across, up)
    axes.set(xlim=(x0 - 1.5, x1 + 1.5), ylim=(y0 - 1.5, y1 + 1.5), ylabel="y, mm")
    sides = ("temporal", "nasal") if lens.side == "R" else ("nasal", "temporal")
    axes.set_xlabel(f"{sides[0]}  ←        x, mm        →  {sides[1]}", color=INK)
    calm(axes)
    small_print(figure, *notes, f"{EYE[lens.side]} lens, seen from the front")
    return figure, axes


def calm(axes: Axes) -> None:
    """Pale grid and frame, so that the data speak."""
    axes.set_axisbelow(True)
    axes.grid(color="#e4e7ea", linewidth=0.6)
    axes.tick_params(colors=QUIET, labelsize=9)
    for spine in axes.spines.values():
        spine.set_color("#c3c9ce")


def titles(figure: Figure, left: float, title: str, *about: str) -> None:
    """Title at the top, from a fraction `left` of the figure's width; below it whatever is said about it, shrunk to fit."""
    width, height = figure.get_size_inches()
    line = "  ·  ".join(words for words in about if words)
    size = min(10.0, 130 * (1 - left) * width / max(len(line), 1))
    figure.text(left, 1 - 0.38 / height, title, size=14, weight="bold", color=INK)
    figure.text(left, 1 - 0.62 / height, line, size=size, color=QUIET, parse_math=False)


def _draw_bands(axes: Axes, lens: Lens, lens_map: LensMap, bands: Bands) -> None:
    outline = Polygon(np.transpose(lens.outline.points()), transform=axes.transData)
    colours, values = bands.colours, extended(lens_map)
    if bands.cyclic:
        scale = {"cmap": ListedColormap(colours), "norm": BoundaryNorm(bands.levels, len(colours))}
        axes.pcolormesh(lens_map.x, lens_map.y, values, shading="nearest", **scale).set_clip_path(outline)
        return
    ends = [colours[0], *colours, colours[-1]]
    axes.contourf(lens_map.x, lens_map.y, values, bands.shifted, colors=ends, extend="both").set_clip_path(outline)
    if bands.constant:
        note = f"constant: {np.mean(bands.span):.2f} {lens_map.unit}"
        axes.text(*lens.outline.centre, note, ha="center", va="bottom", size=11, color=INK, path_effects=_halo())
        return
    _draw_isolines(axes, lens_map, values, bands).set_clip_path(outline)


def scattered(values: Floats) -> bool:
    """Whether less than half of the samples (ny, nx) that hold a value are corners of a cell with four: no bands join them."""
    known = np.isfinite(values)
    cells = known[1:, 1:] & known[1:, :-1] & known[:-1, 1:] & known[:-1, :-1]
    joined = np.zeros_like(known)
    for rows in (slice(1, None), slice(None, -1)):
        for columns in (slice(1, None), slice(None, -1)):
            joined[rows, columns] |= cells
    return bool(2 * joined.sum() < known.sum())


def _draw_points(axes: Axes, lens_map: LensMap, bands: Bands) -> None:
    """Each sample as a disc in its band's colour; the value beside it where they are few."""
    j, i = np.nonzero(np.isfinite(lens_map.values))
    x, y, values = lens_map.x[i], lens_map.y[j], lens_map.values[j, i]
    colours = bands.colours[np.clip(bands.rank(values).astype(int), 0, len(bands.colours) - 1)]
    axes.scatter(x, y, s=150 if x.size <= FEW else 25, c=colours, edgecolors=INK, linewidths=0.9, zorder=4.5)
    for k in range(x.size if x.size <= FEW else 0):
        crowded = ((x > x[k]) & (x < x[k] + 9) & (np.abs(y - y[k]) < 2)).any()
        spot = {"xytext": (-9, 0) if crowded else (9, 0), "textcoords": "offset points", "va": "center"}
        text = f"{values[k]:{'+' if bands.levels[0] < 0 else ''}.2f}"
        halo = {"path_effects": _halo(), "zorder": 6, "size": 9, "color": INK}
        axes.annotate(text, (x[k], y[k]), ha="right" if crowded else "left", **spot, **halo)


def _draw_isolines(axes: Axes, lens_map: LensMap, values: Floats, bands: Bands) -> Any:
    thickness = np.array([0.5, 1.1, 2.0])[bands.weight]
    lines = axes.contour(
        lens_map.x,
        lens_map.y,
        values,
        bands.shifted,
        colors=bands.line_colours(),
        linewidths=thickness,
        linestyles="solid",
    )
    named = [i for i in np.flatnonzero(bands.weight) if bands.span[0] < bands.shifted[i] < bands.span[1]]
    names = {bands.shifted[i]: bands.text[i] for i in named}
    for label in axes.clabel(lines, list(names), fmt=names, fontsize=8, colors=INK, inline_spacing=2):
        label.set_path_effects(_halo())
    return lines


def _halo() -> list[withStroke]:
    return [withStroke(linewidth=2.2, foreground="white", alpha=0.85)]


MARKS = {
    "fitting_point": ("fitting point", "+", 13),
    "prism_reference_point": ("prism reference point", ".", 8),
    "distance_reference_point": ("distance reference point", "o", 12),
    "near_reference_point": ("near reference point", "o", 9),
}


def draw_marks(axes: Axes, lens: Lens) -> None:
    """Reference points of a lens, named for a legend."""
    halo = [withStroke(linewidth=3.0, foreground="white")]
    for name, (x, y) in lens.points.named().items():
        label, marker, size = MARKS[name]
        fill = INK if marker == "." else "none"
        style = {"markersize": size, "markeredgewidth": 1.5, "markeredgecolor": INK, "markerfacecolor": fill}
        axes.plot(x, y, marker, label=label, path_effects=halo, zorder=5, **style)


def colour_bar(axes: Axes, bands: Bands, unit: str) -> None:
    """The bands with their levels and unit; arrows where the map goes beyond the scale."""
    tolerance = 0.01 * float(np.diff(bands.levels).min())
    below, above = bands.span[0] < bands.levels[0] - tolerance, bands.span[1] > bands.levels[-1] + tolerance
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[below, above]
    colours = ListedColormap(bands.colours)
    scale = ScalarMappable(BoundaryNorm(np.arange(len(bands.levels)), len(bands.colours)), colours)
    named = (
        np.flatnonzero(bands.weight) if bands.weight.any() and len(bands.levels) > 6 else np.arange(len(bands.levels))
    )
    bar = axes.figure.colorbar(scale, cax=axes, ticks=named, extend=extend, extendfrac=0.04)
    bar.ax.set_yticklabels([bands.text[i] for i in named])
    bar.ax.tick_params(labelsize=9, colors=INK, length=3)
    bar.ax.minorticks_off()
    bar.outline.set_edgecolor("#8b949c")
    axes.set_title(unit, size=10, color=INK, pad=14 if above else 8)


# ---- profiles and sections ----


def profile_figure(lens: Lens, profile: Profile, subtitle: str = "") -> Figure:
    """Power (D, across) against height y (mm, up) along the main meridian: mean, least and greatest power; astigmatism."""
    figure = blank_figure(9.0, 7.2)
    power, astig = place(figure, 0.8, 0.65, 4.2, 5.6), place(figure, 5.3, 0.65, 1.9, 5.6)
    power.fill_betweenx(profile.y, profile.least_power, profile.greatest_power, color="#f0c48a", alpha=0.6, linewidth=0)
    for values, colour, width, label in (
        (profile.least_power, "#b86e1c", 1.0, "least and greatest power"),
        (profile.greatest_power, "#b86e1c", 1.0, None),
        (profile.mean_power, INK, 2.0, "mean power"),
    ):
        power.plot(values, profile.y, color=colour, linewidth=width, label=label)
    astig.plot(profile.astigmatism, profile.y, color="#1f6aa5", linewidth=2.0)
    _, _, bottom, top = lens.outline.box
    power.set(xlabel="as-worn power, D", ylabel="y, mm")
    astig.set(xlim=(0, max(1.0, 1.1 * np.nanmax(profile.astigmatism, initial=0.0))), xlabel="astigmatism, D")
    for axes in (power, astig):
        axes.set_ylim(bottom, top)
        calm(axes)
    astig.tick_params(labelleft=False)
    _ordered_lines(power, lens)
    _height_lines(power, astig, lens)
    power.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=2, fontsize=9, frameon=False)
    titles(figure, power.get_position().x0, "Power along the main meridian", lens.name, subtitle)
    return figure


def _ordered_lines(axes: Axes, lens: Lens) -> None:
    if lens.ordered is None:
        return
    far, near = (float(mean_power(lens.ordered.power(near))) for near in (False, True))
    bottom, top = axes.get_ylim()
    for value, name, y, va in ((far, "ordered", bottom + 1, "bottom"), (near, "ordered + addition", top - 1, "top")):
        if name == "ordered" or near != far:
            axes.axvline(value, color="#7a3b8f", linewidth=1.1, linestyle=(0, (5, 3)))
            spot = {"rotation": 90, "xytext": (-3, 0), "textcoords": "offset points", "ha": "right", "va": va}
            axes.annotate(f"{name} {value:+.2f} D", (value, y), size=8.5, color="#7a3b8f", path_effects=_halo(), **spot)


def _height_lines(power: Axes, astig: Axes, lens: Lens) -> None:
    """A line at the height of each reference point, named beside the second panel; names of one height share a line."""
    names: dict[float, list[str]] = {}
    for name, (_, y) in lens.points.named().items():
        names.setdefault(y, []).append(MARKS[name][0])
    for y, there in names.items():
        for axes in (power, astig):
            axes.axhline(y, color=QUIET, linewidth=0.8, linestyle=":")
        spot = {"xytext": (6, 0), "textcoords": "offset points", "va": "center"}
        astig.annotate(",\n".join(there), (1, y), xycoords=("axes fraction", "data"), size=8.5, color=INK, **spot)


def section_figure(lens: Lens) -> Figure:
    """Vertical and horizontal cross-section of the lens to one scale, mm, with thickness at the centre and the edges.

    Through x = 0 and y = 0 of the lens frame, or through the middle of an outline that does not hold that point.
    """
    at = (0.0, 0.0) if lens.outline.contains(0.0, 0.0) else lens.outline.centre
    across, up = _section(lens, at, 0), _section(lens, at, 1)
    heights = np.concatenate([across[1:], up[1:]], axis=1)
    x0, x1, y0, y1 = lens.outline.box
    depth = (float(np.nanmin(heights)) - 8, float(np.nanmax(heights)) + 11)
    deep, wide, tall = depth[1] - depth[0], x1 - x0 + 20, y1 - y0 + 10
    scale = min(9.0 / (deep + wide), 6.0 / tall)
    figure = blank_figure(scale * (deep + wide) + 2.0, scale * tall + 1.6)
    upright = place(figure, 0.7, 0.65, scale * deep, scale * tall)
    flat = place(figure, 1.6 + scale * deep, 0.65 + scale * (tall - deep), scale * wide, scale * deep)
    upright.set(xlim=depth, ylim=(y0 - 5, y1 + 5), xlabel="eye ←  z, mm  → scene", ylabel="y, mm")
    flat.set(xlim=(x0 - 10, x1 + 10), ylim=depth[::-1], xlabel="x, mm", ylabel="scene ← z, mm → eye")
    _draw_section(upright, up, upright=True)
    _draw_section(flat, across, upright=False)
    upright.set_title(f"vertical, x = {at[0]:g} mm", size=10, color=INK)
    sides = ("temporal", "nasal") if lens.side == "R" else ("nasal", "temporal")
    flat.set_xlabel(f"{sides[0]}  ←  x, mm  →  {sides[1]}")
    flat.set_title(f"horizontal, y = {at[1]:g} mm, seen from above", size=10, color=INK)
    titles(figure, upright.get_position().x0, "Cross-sections", lens.name)
    thin = lens.minimum_edge_thickness()
    facts = (
        f"centre thickness  {lens.centre_thickness:.2f} mm",
        f"thinnest edge  {thin.thickness:.2f} mm, at x = {thin.x:.1f} mm, y = {thin.y:.1f} mm",
        f"weight  {lens.weight():.1f} g",
        f"material  {lens.material.name}, index {lens.index:.3f} ({lens.wavelength} line)",
    )
    flat.text(
        0,
        -0.4,
        "\n".join(facts),
        transform=flat.transAxes,
        va="top",
        size=10,
        linespacing=1.7,
        color=INK,
        parse_math=False,
    )
    return figure


def _section(lens: Lens, at: tuple[float, float], k: int) -> Floats:
    """Cross-section along x (k = 0) or y (k = 1) through `at`: rows position, back and front height (3, n), mm."""
    low, high = lens.outline.box[2 * k : 2 * k + 2]
    along = np.linspace(low, high, 601)
    x, y = (along, np.full_like(along, at[1])) if k == 0 else (np.full_like(along, at[0]), along)
    section = np.stack([along, lens.back_height(x, y), lens.front_height(x, y)])
    return section[:, lens.outline.contains(x, y) & np.isfinite(section).all(axis=0)]


def _draw_section(axes: Axes, section: Floats, upright: bool) -> None:
    along, back, front = section
    ring = np.stack([np.append(along, along[::-1]), np.append(back, front[::-1])], axis=-1)
    style = {"facecolor": "#cfe3f1", "edgecolor": "#24506e", "linewidth": 1.3}
    axes.add_patch(Polygon(ring[:, ::-1] if upright else ring, **style))
    for i, outwards in ((0, -1), (int(np.argmin(np.abs(along))), 0), (along.size - 1, 1)):
        text = f"{front[i] - back[i]:.2f} mm"
        spot = along[i] + (2 if upright else 5) * outwards, (front[i] + back[i]) / 2 if outwards else front[i] + 2
        align = {"ha": "left" if upright and not outwards else "center", "va": "center"}
        axes.text(*(spot[::-1] if upright else spot), text, size=9, color=INK, **align)
    calm(axes)


# ---- files ----


def figure_array(figure: Figure) -> NDArray[np.uint8]:
    """The figure as a picture (h, w, 3), uint8."""
    canvas = figure.canvas if isinstance(figure.canvas, FigureCanvasAgg) else FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def png_bytes(picture: NDArray[np.uint8] | Figure) -> bytes:
    """A picture (h, w, 3) or a figure as PNG."""
    buffer = BytesIO()
    pixels = figure_array(picture) if isinstance(picture, Figure) else picture
    Image.fromarray(pixels).save(buffer, format="png")
    return buffer.getvalue()


def save_picture(picture: NDArray[np.uint8] | Figure, path: Path) -> None:
    """Write a picture (h, w, 3) as .png, or a figure as .png or, with its text kept as text, as .svg."""
    kind = path.suffix.lower()
    if kind == ".png":
        write_file(path, png_bytes(picture))
    elif kind == ".svg" and isinstance(picture, Figure):
        buffer = BytesIO()
        with rc_context({"svg.fonttype": "none"}):
            picture.savefig(buffer, format="svg")
        write_file(path, buffer.getvalue())
    else:
        raise InputError(f"{path}: a picture is saved as .png, a flat figure also as .svg")
