"""Point files: what each format says of one surface, in every order, side and sign; gaps and spikes; fits against the truth."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lensbench as lb
from lensbench.errors import InputError
from lensbench.formats import Completion, Reading, Writing, read_file
from lensbench.formats.body import BodySurface
from lensbench.formats.flaws import rounding_step, spikes
from lensbench.formats.orientation import ALL, NAMES, Orientation, named
from lensbench.formats.point_grid import PointCloud, PointGrid
from lensbench.layers import MapLayer, Request
from lensbench.optics import surfaces
from lensbench.optics.mirror import mirrored_surface
from lensbench.workbench import assumed_wearer, run

SAMPLES = Path(__file__).parent.parent.parent / "sample_lenses"
DESIGNS = ("regular", "wide_near", "wide_far", "occupational")
ORDERS = [o._replace(z_towards=z) for o in ALL for z in ("eye", "scene")]


def depth(x, y, nasal=1.0):
    """A progressive front of 5 D (n = 1.6) with 2 D of addition below, its near zone 2.5 mm towards the nose."""
    radius = 120.0
    s, u = np.clip((y + 4) / 8, -8, 8), x - 2.5 * nasal
    from scipy.special import ndtr

    phi = np.exp(-(s**2) / 2) / np.sqrt(2 * np.pi)
    along = 64 * ((s**2 + 1) * ndtr(-s) - s * phi) / 2
    bump = along * np.exp(-((u / 36) ** 4)) + ndtr(-s) * 64 * (1 - np.exp(-(u**2) / 128))
    return radius - np.sqrt(radius**2 - x**2 - y**2) + 2 / 600 * bump


def saved(folder, name, content):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def lens_grid(half=30.0, n=61, nasal=1.0):
    g = np.linspace(-half, half, n)
    return g, -depth(*np.meshgrid(g, g), nasal)


@pytest.fixture(scope="module")
def regular():
    """The regular design as a surface: the truth that files of it are measured against."""
    return lb.load_surface(SAMPLES / "regular_R.sdf", Reading("R", "F", 1.598))


# ---- orientation ----


@pytest.mark.parametrize("order", ORDERS, ids=lambda o: f"{o.name}-{o.z_towards}")
@pytest.mark.parametrize("side", "RL")
def test_a_progressive_tells_its_orientation(order, side):
    nasal = 1.0 if side == "R" else -1.0
    _, z = lens_grid(nasal=nasal)
    grid = PointGrid("g", np.round(order.sign * order.to_file(z), 5), 60, 60, 1e-5, side, "F")
    surface, facts, reach = grid.fitted(Reading())
    found = {label: value for label, _, value in facts}["Orientation"]
    assert (found["orientation"], found["z_towards"], found["side"]) == (order.name, order.z_towards, side)
    assert found["certainty"] > 1
    assert surface.sag(7.3, -11.1) == pytest.approx(depth(0, 0, nasal) - depth(7.3, -11.1, nasal), abs=5e-6)
    assert reach == pytest.approx(30)
    assert f"orientation {order.name}" in surface.note


@pytest.mark.parametrize("design", DESIGNS)
@pytest.mark.parametrize("face", "FB")
@pytest.mark.parametrize("cylinder", [0.0, -4.0])
def test_samples_tell_their_orientation_on_either_face(design, face, cylinder):
    """On a back the progressive part is turned over: less curvature where there is more power. A torus may lie beneath."""
    grid = lb.load(SAMPLES / f"{design}_R.sdf")
    x, y = np.meshgrid(*grid.file_axes())
    z = grid.values
    if face == "B":
        z = 2 * (x**2 + y**2) / 240 - z + (x**2 + y**2) / 200
    c, s = np.cos(0.6), np.sin(0.6)
    z = z - cylinder / 1200 * (c * x + s * y) ** 2
    for order in (ALL[1], ALL[6]):
        turned = replace(grid, values=order.to_file(z[::-1]), face=face)
        found = {label: value for label, _, value in turned.fitted(Reading()).facts}["Orientation"]
        assert found["orientation"] == order.name
        assert found["certainty"] > 1


def test_what_looks_the_same_in_every_order_needs_no_telling():
    g = np.linspace(-30, 30, 61)
    x, y = np.meshgrid(g, g)
    round_one = PointGrid("g", np.round((x**2 + y**2) / 240, 6), 60, 60, 1e-6, "R", "F")
    assert "any order" in round_one.fitted(Reading()).surface.note
    flat = PointGrid("g", np.zeros((61, 61)), 60, 60, 1e-6, "R", "F")
    assert "a plane" in flat.fitted(Reading()).surface.note


AMBIGUOUS = {
    "a torus, no order": (lambda x, y: x**2 / 200 + y**2 / 260, {}, "--orientation"),
    "an oblique torus, rows told": (lambda x, y: x**2 / 200 + y**2 / 260 + x * y / 900, {"rows": "horizontal"}, "--orient"),
    "too flat for a sign": (lambda x, y: 1e-4 * x**2 + 2e-4 * y**2 + 1e-6 * x**3, {}, "--z-towards"),
    "no inset": (lambda x, y: depth(x, y, 0.0) + 1e-4 * x * y, {}, "near zone"),
}  # fmt: skip


@pytest.mark.parametrize("case", AMBIGUOUS)
def test_what_the_shape_cannot_tell_is_asked_for(case):
    shape, told, words = AMBIGUOUS[case]
    g = np.linspace(-30, 30, 61)
    x, y = np.meshgrid(g, g[::-1])
    grid = PointGrid("g.sdf", np.round(shape(x, y), 6), 60, 60, 1e-6, "R", "F")
    with pytest.raises(InputError, match=words):
        grid.fitted(Reading(**told))
    o = named("bottom-right-columns")
    told_all = Reading(first_point=o.first_point, rows=o.rows, z_towards="eye")
    assert "as told" in grid.fitted(told_all).surface.note
    flipped = replace(told_all, flip_z=True)
    assert grid.fitted(flipped).surface.sag(9, 5) == pytest.approx(-grid.fitted(told_all).surface.sag(9, 5), abs=1e-7)


def test_a_torus_in_a_format_that_states_its_order_is_taken_as_stated(tmp_path):
    torus = surfaces.toric(1 / 120, 1 / 90, 30.0)
    path = tmp_path / "t.xyz"
    lb.write(path, BodySurface("t", torus, "R", "F"))
    surface = lb.load_surface(path)
    assert "as the format says" in surface.note
    assert surface.sag(11.0, 7.0) == pytest.approx(torus.sag(11.0, 7.0), abs=1e-6)


def test_a_told_orientation_stands_against_the_shape_which_objects():
    grid = lb.load(SAMPLES / "regular_R.sdf")
    right = grid.fitted(Reading(first_point="top-left", rows="horizontal", z_towards="eye")).surface
    assert "although" not in right.note
    wrong = grid.fitted(Reading(first_point="bottom-left", rows="horizontal", z_towards="eye")).surface
    assert "although the shape speaks for top-left-rows" in wrong.note
    assert wrong.sag(3.0, -9.0) == pytest.approx(float(right.sag(3.0, 9.0)), abs=1e-6)


def test_orientations_have_inverses():
    z = np.arange(12.0).reshape(3, 4)
    for o in ALL:
        assert np.array_equal(o.to_lens(o.to_file(z)), z)
        assert named(o.name) == o
        assert np.abs(np.linalg.det(o.matrix())) == pytest.approx(1.0)
    with pytest.raises(InputError, match="top-left-rows"):
        named("upside-down")
    assert len(set(NAMES)) == 8


# ---- round trips ----

WRITERS = {"sdf": ORDERS, "hmf": ORDERS, "xyz": ORDERS, "dat": [Orientation()]}


@given(
    st.sampled_from(sorted(WRITERS)), st.integers(0, 15), st.sampled_from([0.75, 1.0, 1.3, 2.0]), st.integers(18, 30),
    st.integers(3, 7), st.sampled_from("RL"), st.booleans(),
)  # fmt: skip
def test_round_trips_keep_the_sag_to_the_written_digits(
    tmp_path_factory, kind, order, pitch, half, decimals, side, mirror
):
    nasal = 1.0 if side == "R" else -1.0
    truth = surfaces.fitted_grid(*(lens_grid(40, 81, nasal)[0],) * 2, lens_grid(40, 81, nasal)[1], 1e-9)
    truth = mirrored_surface(truth) if mirror else truth
    side = {"R": "L", "L": "R"}[side] if mirror else side
    o = WRITERS[kind][order % len(WRITERS[kind])]
    path = tmp_path_factory.mktemp("trip") / f"lens_{side}.{kind}"
    writing = Writing(pitch, (2.0 * half, 2.0 * half), o, decimals)
    said = lb.write(path, BodySurface("x", truth, side, "F"), writing=writing)
    assert o.first_point in said
    assert o.z_towards in said
    grid = lb.load(path)
    assert grid.side == side
    x, y = np.meshgrid(*(np.arange(-np.floor(half / pitch + 1e-6), np.floor(half / pitch + 1e-6) + 1) * pitch,) * 2)
    order_of_values = o if kind != "xyz" else Orientation(z_towards=o.z_towards)
    written = order_of_values.sign * order_of_values.to_file(truth.sag(x, y))
    assert grid.values == pytest.approx(written, abs=0.5001 * 10.0**-decimals)
    assert grid.pitch == pytest.approx((pitch, pitch))
    told = Reading(first_point=order_of_values.first_point, rows=order_of_values.rows, z_towards=o.z_towards)
    back = grid.fitted(told).surface
    assert back.sag(5.5, -9.5) == pytest.approx(float(truth.sag(5.5, -9.5)), abs=3 * 10.0**-decimals)


@given(st.integers(6, 14), st.integers(6, 14), st.floats(5, 80), st.floats(5, 80), st.integers(0, 2**32 - 1))
def test_missing_values_come_back_as_gaps(tmp_path_factory, nx, ny, width, height, seed):
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(-width / 2, width / 2, nx), np.linspace(-height / 2, height / 2, ny))
    z = np.round((x**2 + y**2) / 300, 6)
    z[rng.random(z.shape) < 0.05] = np.nan
    rows = "".join("ZZ=" + ";".join("?" if np.isnan(v) else f"{v:.6f}" for v in row) + "\n" for row in z)
    path = saved(tmp_path_factory.mktemp("gaps"), "a.sdf", f"SURFMT=1;R;F;{nx};{ny};{width};{height};0\n{rows}")
    (grid,) = read_file(path).items
    assert np.array_equal(grid.values, z, equal_nan=True)
    if np.isfinite(z).sum() >= 36:
        surface = grid.fitted(Reading(z_towards="eye", first_point="top-left", rows="horizontal")).surface
        corner = min(width, height) / 4
        assert surface.sag(corner, 0.0) == pytest.approx(-(corner**2) / 300, abs=2e-5)


def test_counts_and_extents_in_either_order(tmp_path):
    """Fields 4/5 and 6/7 of SURFMT: which is which is told by the records."""
    x, y = np.meshgrid(np.linspace(-20, 20, 21), np.linspace(-15, 15, 16))
    rows = "".join("ZZ=" + ";".join(f"{v:.6f}" for v in row) + "\n" for row in (x**2 + y**2) / 240)
    for fields in ("21;16;40;30", "16;21;30;40"):
        grid = lb.load(saved(tmp_path, "a.sdf", f"SURFMT=1;R;F;{fields};0\n{rows}"))
        assert (grid.values.shape, grid.width, grid.height) == ((16, 21), 40.0, 30.0)


def test_units_and_gaps_of_a_zemax_grid(tmp_path):
    g, z = lens_grid(30, 61)
    values = -z[::-1] / 25.4
    flags = np.hypot(*np.meshgrid(g, g)) > 29.5
    lines = ["! a comment", "61 61 0.03937007874 0.03937007874 2 0 0"]
    lines += [f"{0 if f else v:.8f} 0 0 0 {int(f)}" for v, f in zip(values.ravel(), flags.ravel(), strict=True)]
    grid = lb.load(saved(tmp_path, "lens_R.dat", "\n".join(lines)))
    assert grid.pitch == pytest.approx((1.0, 1.0), abs=1e-6)
    assert np.array_equal(np.isnan(grid.values), flags)
    surface, _, reach = grid.fitted(Reading())
    assert surface.sag(10.0, -12.0) == pytest.approx(depth(0, 0) - depth(10.0, -12.0), abs=1e-6)
    assert 28.5 < reach <= 30


def test_slopes_of_a_zemax_grid_check_its_order(tmp_path, regular):
    path = tmp_path / "a_R.dat"
    lb.write(path, BodySurface("x", regular, "R", "F"))
    assert "slopes in the file agree" in lb.load(path).remark
    lines = path.read_text().splitlines()
    turned = [line.split() for line in lines[1:]]
    wrong = [f"{z} {fx} {-float(fy)} {fxy} {n}" for z, fx, fy, fxy, n in turned]
    assert "do not fit" in lb.load(saved(tmp_path, "b_R.dat", "\n".join([lines[0], *wrong]))).remark


def test_an_interferogram_with_a_surface(tmp_path):
    _, z = lens_grid(30, 41)
    counts = np.round(-z[::-1] * 1000 / 0.6328 * 2).astype(int)
    assert np.abs(counts).max() < 32767
    numbers = "\n".join(" ".join(map(str, row)) for row in counts)
    grid = lb.load(
        saved(tmp_path, "R_a.int", f"! made here\nA progressive\nGRD 41 41 SUR WVL 0.6328 SSZ 2\n{numbers}\n")
    )
    assert grid.values == pytest.approx(-z[::-1], abs=0.6328e-3 / 4 * 1.001)
    assert "too coarse" in grid.remark
    assert grid.width == 60


LISTS = {
    "spaces": ("{0} {1} {2}", ""),
    "commas": ("{0}, {1}, {2}", ""),
    "semicolons": ("{0};{1};{2}", ""),
    "tabs": ("{0}\t{1}\t{2}", ""),
    "named in another order": ("{2},{0},{1}", "sag (mm),x (mm),y (mm)\n"),
    "named with units": ("{0};{1};{3}", "X [mm];Y [mm];Z [um]\n"),
    "comments and a column more": ("{0} {1} {2} 7.5", "# made here\n! so\n"),
}


@pytest.mark.parametrize("kind", LISTS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_point_lists_as_programs_write_them(tmp_path, kind, encoding, end):
    form, head = LISTS[kind]
    g, z = lens_grid(20, 21)
    x, y = np.meshgrid(g, g)
    lines = [
        form.format(*(f"{v:.6f}" for v in (a, b, -c)), f"{-c * 1000:.3f}")
        for a, b, c in zip(x.ravel(), y.ravel(), z.ravel(), strict=True)
    ]
    path = tmp_path / "12R.txt"
    path.write_bytes((head + "\n".join(lines) + "\n").replace("\n", end).encode(encoding))
    grid = lb.load(path)
    assert isinstance(grid, PointGrid)
    assert grid.side == "R"
    assert grid.values[::-1] == pytest.approx(-z, abs=1e-6)
    assert grid.digit == pytest.approx(1e-6)


def test_scattered_points(tmp_path, regular):
    rng = np.random.default_rng(3)
    x, y = rng.uniform(-30, 30, (2, 5000))
    inside = np.hypot(x, y) < 30
    x, y = np.round(x[inside], 4), np.round(y[inside], 4)
    lines = [f"{a:.4f} {b:.4f} {c:.6f}" for a, b, c in zip(x, y, -regular.sag(x, y), strict=True)]
    lines[17] = lines[17][:-3] + "9" + lines[17][-2:]
    cloud = lb.load(saved(tmp_path, "cloud_R.xyz", "\n".join(lines)))
    assert isinstance(cloud, PointCloud)
    fit = cloud.fitted(Reading(face="F", index=1.598))
    facts = {label: value for label, _, value in fit.facts}
    assert facts["Orientation"]["side"] == "R"
    at = np.meshgrid(*(np.linspace(-15, 15, 16),) * 2)
    gap = fit.surface.surface_power(*at, 1.598) - regular.surface_power(*at, 1.598)
    assert np.sqrt(np.mean(gap**2)) < 0.01


# ---- rounding, spikes, noise ----


@pytest.mark.parametrize(
    ("step", "digit", "found"),
    [(1e-4, 1e-4, 1e-4), (5e-4, 1e-6, 5e-4), (2.5e-5, 1e-7, 2.5e-5), (1e-6, 1e-6, 1e-6), (1e-3, 1e-9, 1e-3)],
)
def test_the_step_between_the_values_is_found(step, digit, found):
    values = np.round(depth(*np.meshgrid(*(np.linspace(-30, 30, 61),) * 2)) / step) * step
    assert rounding_step(values, digit) == pytest.approx(found)
    assert rounding_step(values + 3e-7 * (digit == 1e-7), digit) == pytest.approx(found)


def test_single_precision_is_found():
    values = depth(*np.meshgrid(*(np.linspace(-30, 30, 61),) * 2)).astype(np.float32)
    written = np.array([[float(f"{v:.9f}") for v in row] for row in values])
    assert 1e-7 < rounding_step(written, 1e-9) < 2e-6


@pytest.mark.parametrize("design", DESIGNS)
@pytest.mark.parametrize("pitch", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("decimals", [3, 4, 5, 6])
def test_a_real_progressive_raises_no_false_alarm(design, pitch, decimals):
    surface = lb.load_surface(SAMPLES / f"{design}_R.sdf")
    g = np.arange(-32, 32.1, pitch)
    assert not spikes(np.round(surface.sag(*np.meshgrid(g, g)), decimals), 10.0**-decimals).any()


@given(st.integers(0, 64), st.integers(0, 64), st.sampled_from([1, -1]), st.floats(1e-4, 2))
def test_a_spike_is_found_and_costs_nothing(row, column, sign, size):
    grid = lb.load(SAMPLES / "regular_R.sdf")
    if row in (0, 1, 2, 62, 63, 64) and column in (0, 1, 2, 62, 63, 64):
        row = 30
    values = grid.values.copy()
    values[row, column] += sign * size
    spoiled = replace(grid, values=values).fitted(Reading(index=1.598))
    refused = next(value for label, _, value in spoiled.facts if label == "Points refused")
    assert refused.tolist() == [[row + 1, column + 1]]
    assert f"row {row + 1}, column {column + 1}" in spoiled.surface.note
    x, y = np.clip([column - 32.0, 32.0 - row], -31, 31)
    clean = grid.fitted(Reading(index=1.598)).surface
    assert spoiled.surface.surface_power(x, y, 1.598) == pytest.approx(clean.surface_power(x, y, 1.598), abs=0.03)


def test_an_edge_in_the_surface_is_no_row_of_spikes():
    grid = lb.load(SAMPLES / "regular_R.sdf")
    values = grid.values.copy()
    values[40:] += 0.05
    assert not spikes(values, 1e-6).any()


def test_noise_above_the_digits_is_smoothed_and_said(regular):
    rng = np.random.default_rng(5)
    grid = lb.load(SAMPLES / "regular_R.sdf")
    noisy = replace(grid, values=np.round(grid.values + rng.normal(0, 2e-5, grid.values.shape), 6))
    fit = noisy.fitted(Reading(index=1.598))
    assert "noisier" in fit.surface.note
    assert next(v for label, _, v in fit.facts if label == "Rounding")["noise_found_mm"] == pytest.approx(
        2e-5, rel=0.15
    )
    at = np.meshgrid(*(np.linspace(-15, 15, 16),) * 2)
    gap = fit.surface.surface_power(*at, 1.598) - regular.surface_power(*at, 1.598)
    assert np.sqrt(np.mean(gap**2)) < 0.03


@pytest.mark.parametrize("decimals", [4, 5, 6])
@pytest.mark.parametrize("pitch", [0.5, 1.0])
def test_the_power_noise_that_is_stated_is_about_what_there_is(regular, decimals, pitch):
    g = np.arange(-32, 32.1, pitch)
    grid = PointGrid("g", np.round(-regular.sag(*np.meshgrid(g, g))[::-1], decimals), 64, 64, 10.0**-decimals, "R", "F")
    fit = grid.fitted(Reading(index=1.598))
    stated = next(value for label, _, value in fit.facts if label == "Power noise")
    at = np.meshgrid(*(np.linspace(-18, 18, 37),) * 2)
    from lensbench.optics.conventions import astigmatism

    gap = astigmatism(fit.surface.surface_power(*at, 1.598) - regular.surface_power(*at, 1.598))
    assert np.sqrt(np.mean(gap**2)) < 2 * stated["smoothed_D"] + 1e-3
    assert stated["smoothed_D"] <= stated["interpolated_D"]


# ---- one lens in all formats ----


@pytest.fixture(scope="module")
def same_lens(tmp_path_factory):
    """The regular lens with its front from each kind of file, and the map of its sample."""
    folder = tmp_path_factory.mktemp("same")
    lens = lb.load_lens(SAMPLES / "regular_R.toml")
    names = ["a_R.sdf", "a_R.hmf", "a_R.dat", "a_R.xyz", "a.json"]
    for name in names:
        lb.write(folder / name, BodySurface("x", lens.front, "R", "F"))
    lb.write(folder / "a.toml", lens)
    lenses = {n: replace(lens, front=lb.load_surface(folder / n, Reading("R" if n != "a.json" else ""))) for n in names}
    return lens, lenses | {"a.toml": lb.load_lens(folder / "a.toml")}


@pytest.mark.parametrize("quantity", ["mean_power", "astigmatism"])
def test_every_format_gives_the_same_map(same_lens, quantity):
    lens, others = same_lens
    wearer = assumed_wearer(lens)
    layer = MapLayer(quantity, np.inf, samples=33)
    truth = run(Request(lens, wearer, layer)).values
    for name, other in others.items():
        gap = run(Request(other, wearer, layer)).values - truth
        stated = 0.002 if name.startswith("a_R") else 1e-6
        assert np.sqrt(np.nanmean(gap**2)) < stated, name


def test_the_lens_that_ships_in_three_formats_is_one_lens():
    found = [lb.load_lens(SAMPLES / name) for name in ("regular_R.sdf", "regular_R.hmf", "regular_R_zemax.dat")]
    wearer = assumed_wearer(found[0])
    maps = [run(Request(lens, wearer, MapLayer("mean_power", np.inf, samples=33))).values for lens in found]
    for lens, values in zip(found, maps, strict=True):
        assert lens.side == "R"
        assert np.sqrt(np.nanmean((values - maps[0]) ** 2)) < 0.003


# ---- a lens from a lone surface ----


def test_a_lone_front_becomes_a_lens_that_says_what_was_assumed():
    lens = lb.load_lens(SAMPLES / "regular_R.sdf", material="1.5945/41")
    for words in (
        "orientation top-left-rows",
        "certainty",
        "back sphere",
        "diameter 60 mm",
        "addition 2 D",
        "centre thickness",
    ):
        assert words in lens.note
    assert lens.points.near_reference_point[0] == pytest.approx(2.5, abs=0.6)
    assert lens.minimum_edge_thickness().thickness >= 0.99
    reading = lb.look_through(lens, assumed_wearer(lens), [0.0], [8.0])
    assert abs(reading.as_worn_power(np.inf).sphere[0]) < 0.15


def test_what_is_told_is_taken():
    told = Completion(thickness=4.0, back_radius=200.0, diameter=50.0)
    lens = lb.load_lens(SAMPLES / "regular_R.sdf", told=told)
    assert (lens.centre_thickness, lens.back.p[0]) == (4.0, 1 / 200)
    assert lens.outline.radii.max() == pytest.approx(25.0)
    assert "thickness" not in lens.note
    minus = lb.load_lens(SAMPLES / "regular_R.sdf", told=Completion(power=-3.0))
    assert minus.ordered.sphere == -3.0
    reading = lb.look_through(minus, assumed_wearer(minus), [0.0], [8.0])
    assert reading.as_worn_power(np.inf).sphere[0] == pytest.approx(-3.0, abs=0.3)


def test_a_lone_back_gets_a_front():
    lens = lb.load_lens(SAMPLES / "back_progressive_R.sdf")
    assert "front sphere" in lens.note
    assert 1 / lens.front.p[0] == pytest.approx(119.6, rel=0.02)


def test_front_and_back_of_both_sides_are_two_whole_lenses(tmp_path):
    from lensbench.optics.mirror import mirrored

    lens = lb.load_lens(SAMPLES / "wide_near_R.toml")
    path = tmp_path / "pair.sdf"
    lb.write(path, lens, mirrored(lens))
    assert [(i.side, i.face) for i in read_file(path).items] == [("R", "F"), ("R", "B"), ("L", "F"), ("L", "B")]
    told = Completion(thickness=2.2)  # the progressive front tells the order for the torus, which cannot
    right, left = (lens for lens, _ in lb.load_pair(path, told=told))
    assert (right.side, left.side) == ("R", "L")
    x, y = np.array([5.0, -12.0]), np.array([-9.0, 14.0])
    assert right.back.sag(x, y) == pytest.approx(lens.back.sag(x, y), abs=2e-6)
    assert left.front.sag(-x, y) == pytest.approx(right.front.sag(x, y), abs=1e-6)
    assert "back" not in right.note.partition("assumed:")[2]


def test_a_face_that_the_file_does_not_hold():
    with pytest.raises(InputError, match="face F; wanted is side R face B"):
        lb.load_lens(SAMPLES / "regular_R.sdf", told=Completion(reading=Reading(face="B")))


def test_toml_written_comes_back(tmp_path):
    for name in ("toric_R.toml", "wide_near_R.toml", "sphere_plus_4_R.toml"):
        lens = lb.load_lens(SAMPLES / name)
        lb.write(tmp_path / name, lens)
        again = lb.load_lens(tmp_path / name)
        x, y = np.array([3.0, -14.0, 21.0]), np.array([-18.0, 9.0, 5.0])
        assert again.thickness(x, y) == pytest.approx(lens.thickness(x, y), abs=1e-9)
        assert (again.side, again.ordered.power().tolist()) == (lens.side, lens.ordered.power().tolist())
        assert again.points.named() == lens.points.named()
