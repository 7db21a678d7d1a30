"""Zemax files: written here after the documented grammar; surfaces against their closed forms in Zemax's own axes."""

import numpy as np
import pytest

import lensbench as lb
from lensbench.errors import InputError
from lensbench.formats import read_file
from lensbench.optics.lens import surface_height

FRONT = "  TYPE STANDARD\n  CURV 0.01\n  CONI -0.5\n"
BACK = "  TYPE STANDARD\n  CURV 0.015\n"
X, Y = np.meshgrid(np.linspace(-20, 20, 9), np.linspace(-18, 18, 7))


def zmx(
    front=FRONT, back=BACK, *, glass="___BLANK 1 0 1.592 41 0 0 0 0 0 0", between="", before="", stop_at=3, unit="MM"
):
    """Object, (breaks), front, (breaks), back, stop and image."""
    blocks = ["  TYPE STANDARD\n  CURV 0\n  DISZ INFINITY\n", *([before] if before else [])]
    blocks += [f"{front}  GLAS {glass}\n  DISZ 3.0\n  DIAM 30 0 0 0 1\n", *([between] if between else [])]
    blocks += [f"{back}  DISZ 25\n  DIAM 28\n", "  TYPE STANDARD\n  CURV 0\n  DISZ 0\n", "  TYPE STANDARD\n  CURV 0\n"]
    blocks[0 if stop_at == 0 else -2] = "  STOP\n" + blocks[0 if stop_at == 0 else -2]
    text = f"VERS 200101 1 2\nMODE SEQ\nNAME test\nUNIT {unit} X W X CM MR CPMM\n"
    return text + "".join(f"SURF {k}\n{block}" for k, block in enumerate(blocks))


def saved(folder, text, encoding="utf-16"):
    path = folder / "lens.zmx"
    path.write_bytes(text.encode(encoding))
    return path


def conic(c, k, q):
    return c * q / (1 + np.sqrt(1 - (1 + k) * c * c * q))


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-8", "utf-8-sig", "latin-1"])
def test_a_lens_in_every_encoding(tmp_path, encoding):
    lens = lb.load_lens(
        saved(tmp_path, zmx().replace("NAME test", "NAME Müller" if encoding != "utf-8" else "NAME x"), encoding)
    )
    assert lens.front_height(X, Y) == pytest.approx(3 - conic(0.01, -0.5, X**2 + Y**2), abs=1e-12)
    assert lens.back_height(X, Y) == pytest.approx(-conic(0.015, 0, X**2 + Y**2), abs=1e-12)
    assert (lens.material.n_d, lens.material.abbe) == (1.592, 41)
    assert lens.material.n_e == pytest.approx(1.5955, abs=2e-4)
    assert lens.outline.box == pytest.approx((-28, 28, -28, 28))


def test_light_from_the_eye_makes_the_first_surface_the_back(tmp_path):
    lens = lb.load_lens(
        saved(tmp_path, zmx("  TYPE STANDARD\n  CURV -0.015\n", "  TYPE STANDARD\n  CURV -0.01\n", stop_at=0))
    )
    assert 1 / lens.front.p[0] == pytest.approx(100)
    assert 1 / lens.back.p[0] == pytest.approx(1 / 0.015)


def even_asphere(x, y):
    q = x * x + y * y
    return conic(0.01, -0.5, q) + 1e-4 * q - 2e-7 * q**2 + 1e-10 * q**3


def toroid(x, y):
    curve = conic(0.012, 0.3, y * y) + 1e-5 * y**2 - 1e-8 * y**4
    return 80 - np.sqrt((80 - curve) ** 2 - x * x)


def torus(x, y):
    return 80 - np.sqrt((80 - conic(0.012, 0, y * y)) ** 2 - x * x)


def biconic(x, y):
    cx, cy, kx, ky = 1 / 90, 0.012, 0.4, -0.5
    root = np.sqrt(1 - (1 + kx) * (cx * x) ** 2 - (1 + ky) * (cy * y) ** 2)
    return (cx * x * x + cy * y * y) / (1 + root)


SURFACES = {
    "asphere refitted": (
        "EVENASPH\n  CURV 0.01\n  CONI -0.5\n  PARM 1 1e-4\n  PARM 2 -2e-7\n  PARM 3 1e-10\n",
        even_asphere,
    ),
    "asphere exact": (
        "EVENASPH\n  CURV 0.01\n  CONI -0.5\n  PARM 2 -2e-7\n  PARM 3 1e-10\n",
        lambda x, y: even_asphere(x, y) - 1e-4 * (x * x + y * y),
    ),
    "toroid refitted": ("TOROIDAL\n  CURV 0.012\n  CONI 0.3\n  PARM 1 80\n  PARM 2 1e-5\n  PARM 3 -1e-8\n", toroid),
    "torus": ("TOROIDAL\n  CURV 0.012\n  PARM 1 80\n", torus),
    "cylinder": ("TOROIDAL\n  CURV 0.012\n  PARM 1 0\n", lambda x, y: conic(0.012, 0, y * y)),
    "biconic": ("BICONICX\n  CURV 0.012\n  CONI -0.5\n  PARM 1 90\n  PARM 2 0.4\n", biconic),
}


@pytest.mark.parametrize("stop_at", [0, 3])
def test_a_grid_beside_the_file_adds_to_its_asphere(tmp_path, stop_at):
    """The grid file is written here after the user guide: first point at -x, +y, x fastest; z along the light."""

    def bump(x, y):
        return 0.02 * np.exp(-((x - 5) ** 2 + (y + 9) ** 2) / 150)

    g = np.linspace(-32, 32, 65)
    gx, gy = np.meshgrid(g, g[::-1])
    lines = "".join(f"{z:.9f} 0 0 0\n" for z in bump(gx, gy).ravel())
    (tmp_path / "bump.dat").write_text(f"65 65 1 1 0 0 0\n{lines}")
    front = "  TYPE GRID_SAG\n  CURV 0.01\n  CONI -0.5\n  COMM bump.dat\n"
    body = read_file(saved(tmp_path, zmx(front, stop_at=stop_at))).items[0]
    depth = conic(0.01, -0.5, X**2 + Y**2)
    wanted = depth + bump(X, Y) if stop_at == 0 else -(depth + bump(-X, Y))
    found = (body.back if stop_at == 0 else body.front).sag(X, Y)
    assert found - found[3, 4] == pytest.approx(wanted - wanted[3, 4], abs=1e-6)
    assert "GRID_SAG, refitted" in body.understood[0]


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("stop_at", [0, 3])
def test_every_surface_type(tmp_path, name, stop_at):
    records, depth = SURFACES[name]
    body = read_file(saved(tmp_path, zmx(f"  TYPE {records}", stop_at=stop_at))).items[0]
    surface = body.back if stop_at == 0 else body.front
    wanted = depth(X, Y) if stop_at == 0 else -depth(-X, Y)
    assert surface.sag(X, Y) == pytest.approx(wanted, abs=1e-7)
    assert ("refitted" in body.understood[0]) == ("refitted" in name)


def test_units(tmp_path):
    scaled = {"CM": 10.0, "IN": 25.4, "METER": 1000.0}
    for unit, mm in scaled.items():
        front = f"  TYPE EVENASPH\n  CURV {0.01 * mm}\n  PARM 2 {-2e-7 * mm**3}\n"
        text = zmx(front, f"  TYPE TOROIDAL\n  CURV {0.012 * mm}\n  PARM 1 {80 / mm}\n", unit=unit)
        text = (
            text.replace("DISZ 3.0", f"DISZ {3 / mm}")
            .replace("DIAM 30", f"DIAM {30 / mm}")
            .replace("DIAM 28", f"DIAM {28 / mm}")
        )
        lens = lb.load_lens(saved(tmp_path, text))
        assert lens.centre_thickness == pytest.approx(3)
        assert lens.outline.box[1] == pytest.approx(28)
        q = X**2 + Y**2
        assert lens.front.sag(X, Y) == pytest.approx(-conic(0.01, 0, q) + 2e-7 * q**2, abs=1e-10)
        assert lens.back.sag(X, Y) == pytest.approx(-torus(X, Y), abs=1e-10)


@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("stop_at", [0, 3])
def test_a_break_within_the_lens_places_the_second_surface(tmp_path, order, stop_at):
    """The second surface's points, taken through the break by rotation matrices written out here, lie on the surface read."""
    dx, dy, ax, ay, az = 0.4, -0.7, 1.5, -2.0, 30.0
    numbers = "".join(f"  PARM {k} {v}\n" for k, v in enumerate((dx, dy, ax, ay, az, order), start=1))
    text = zmx(back="  TYPE BICONICX\n  CURV 0.012\n  CONI -0.5\n  PARM 1 90\n  PARM 2 0.4\n", stop_at=stop_at,
               between=f"  TYPE COORDBRK\n  CURV 0\n{numbers}  DISZ 0.5\n")  # fmt: skip
    body = read_file(saved(tmp_path, text)).items[0]
    a, b, g = np.radians([ax, ay, az])
    rx = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    ry = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    rz = np.array([[np.cos(g), -np.sin(g), 0], [np.sin(g), np.cos(g), 0], [0, 0, 1]])
    local = np.stack([X, Y, biconic(X, Y)], -1) + np.array([0, 0, 0.5])
    if order == 0:
        points = [0, 0, 3.0] + np.array([dx, dy, 0]) + local @ (rx @ ry @ rz).T
    else:
        points = [0, 0, 3.0] + (local + np.array([dx, dy, 0])) @ (rz @ ry @ rx).T
    points = points if stop_at == 0 else points * [-1, 1, -1]
    surface = body.front if stop_at == 0 else body.back
    vertex = body.centre_thickness if stop_at == 0 else -body.centre_thickness
    assert vertex + surface_height(surface, points[..., 0], points[..., 1]) == pytest.approx(points[..., 2], abs=1e-9)


def test_breaks_before_the_lens_are_position_of_wear(tmp_path):
    text = zmx(before="  TYPE COORDBRK\n  CURV 0\n  PARM 3 8\n  DISZ 0\n")
    body = read_file(saved(tmp_path, text)).items[0]
    assert body.front.tilt == (0, 0)
    assert "position of wear" in body.understood[-1]


def test_a_model_eye_behind_the_lens_does_no_harm(tmp_path):
    eye = "  TYPE STANDARD\n  CURV 0.13\n  DISZ 0.5\n  GLAS CORNEA 0 0 1.5 40\n"
    aqueous = "  TYPE STANDARD\n  CURV 0.15\n  DISZ 3\n  GLAS AQUEOUS 0 0 1.5 40\n"
    lens = lb.load_lens(saved(tmp_path, f"{zmx()}SURF 5\n{eye}SURF 6\n{aqueous}SURF 7\n  TYPE STANDARD\n"))
    assert lens.front_height(X, Y) == pytest.approx(3 - conic(0.01, -0.5, X**2 + Y**2), abs=1e-12)


def test_glass_by_name(tmp_path):
    assert lb.load_lens(saved(tmp_path, zmx(glass="POLYCARB 0 0 1.5 40 0 0"))).material.name == "polycarbonate"
    assert lb.load_lens(saved(tmp_path, zmx(glass="MR8"))).material.name == "MR-8"


BAD = [
    ("", "no SURF record"),
    ("MODE NSC\nSURF 0\n", "line 1: MODE NSC: only sequential"),
    (zmx(unit="MILES"), "line 4: UNIT MILES: not known; there are MM, CM, IN, METER"),
    (zmx(glass="N-SF57 0 0 1.5 40"), "surface 1: GLAS N-SF57 is not in the table"),
    (zmx(glass="MIRROR"), "surface 1 is a mirror"),
    (zmx(back=BACK + "  GLAS MR8\n"), "glass after surfaces 1, 2"),
    (zmx().replace("GLAS", "GLSA"), "no glass (GLAS)"),
    (zmx(FRONT.replace("STANDARD", "SZERNSAG")), "surface 1 is of type SZERNSAG; there are STANDARD, EVENASPH"),
    (zmx(FRONT.replace("0.01", "1,5")), "CURV: '1,5' is not a number"),
    (zmx(FRONT.replace("0.01", "nan")), "CURV: nan is not a finite number"),
    (zmx(FRONT.replace("CURV 0.01", "CURV")), "CURV: value 1 is missing"),
    (zmx().replace("DISZ 3.0", "DISZ INFINITY"), "the glass is endlessly thick"),
    (zmx().replace("DISZ 3.0", "DISZ -3.0"), "needs a thickness"),
    (zmx("  TYPE TOROIDAL\n  CURV 0.012\n  CONI 0.1\n  PARM 13 5\n"), "TOROIDAL with Zernike terms"),
    (zmx("  TYPE GRID_SAG\n"), "GRID_SAG: name its data file"),
    (zmx("  TYPE GRID_SAG\n  COMM nowhere.dat\n"), "nowhere.dat: no such file"),
    (zmx(glass="___BLANK 1 0 9.9 40"), "are no spectacle lens's"),
]


@pytest.mark.parametrize(("text", "words"), BAD)
def test_bad_files_say_so(tmp_path, text, words):
    path = saved(tmp_path, text)
    with pytest.raises(InputError) as failure:
        lb.load_lens(path)
    assert words in str(failure.value)
    assert str(tmp_path) in str(failure.value)
