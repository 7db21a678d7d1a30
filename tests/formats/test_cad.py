"""STEP and IGES: files are made here with the CAD package itself, from primitives whose radii are known."""

import numpy as np
import pytest

from lensbench.errors import InputError
from lensbench.formats.cad import read_cad
from lensbench.formats.cad_writer import step_text
from lensbench.optics import surfaces
from lensbench.optics.lens import ellipse_outline, surface_height
from lensbench.optics.materials import MATERIALS

pytest.importorskip("OCP")
from OCP import BRepAlgoAPI, BRepPrimAPI, IGESControl, STEPControl
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace as MakeFace
from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.Geom import Geom_ToroidalSurface
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Pln, gp_Pnt

X, Y = np.meshgrid(np.linspace(-22, 22, 23), np.linspace(-18, 18, 19))


def at(x, y, z, towards=(0, 0, 1)):
    return gp_Ax2(gp_Pnt(x, y, z), gp_Dir(*towards))


def meniscus(front=90.0, back=120.0, thickness=3.0, radius=30.0, x=0.0, y=0.0):
    """A round solid between two spheres, +z to the scene, back vertex at the origin (moved by x, y)."""
    rod = BRepPrimAPI.BRepPrimAPI_MakeCylinder(at(x, y, -20), radius, 60).Shape()
    inside = BRepPrimAPI.BRepPrimAPI_MakeSphere(at(x, y, thickness - front), front).Shape()
    outside = BRepPrimAPI.BRepPrimAPI_MakeSphere(at(x, y, -back), back).Shape()
    return BRepAlgoAPI.BRepAlgoAPI_Cut(BRepAlgoAPI.BRepAlgoAPI_Common(rod, inside).Shape(), outside).Shape()


def saved(shape, path, unit="MM"):
    from OCP.Interface import Interface_Static

    if path.suffix == ".igs":
        writer = IGESControl.IGESControl_Writer(unit, 1)
        writer.AddShape(shape)
        writer.Write(str(path))
        return path
    writer = STEPControl.STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.Transfer(shape, STEPControl.STEPControl_StepModelType.STEPControl_AsIs)
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    writer.Write(str(path))
    return path


def assert_sags(body, front, back, within=1e-9):
    assert body.front.sag(X, Y) == pytest.approx(surfaces.sphere(front).sag(X, Y), abs=within)
    assert body.back.sag(X, Y) == pytest.approx(surfaces.sphere(back).sag(X, Y), abs=within)


@pytest.mark.parametrize("unit", ["MM", "INCH", "M"])
def test_spheres_are_exact_whatever_the_unit(tmp_path, unit):
    body = read_cad(saved(meniscus(), tmp_path / "lens.step", unit))
    assert_sags(body, 90, 120)
    assert body.centre_thickness == pytest.approx(3, abs=1e-9)
    assert body.outline.box == pytest.approx((-30, 30, -30, 30), abs=1e-3)
    assert "sphere, radius 90 mm, exact" in body.understood[0]


def test_other_faces_are_sampled_and_refitted(tmp_path):
    shape = BRepBuilderAPI_NurbsConvert(meniscus()).Shape()
    body = read_cad(saved(shape, tmp_path / "lens.stp"))
    assert "refitted" in body.understood[0]
    assert_sags(body, 90, 120, 1e-6)
    assert body.front.derivatives(X, Y).fxx == pytest.approx(surfaces.sphere(90).derivatives(X, Y).fxx, abs=2e-6)


def test_iges(tmp_path):
    assert_sags(read_cad(saved(meniscus(), tmp_path / "lens.igs")), 90, 120, 1e-6)


def test_a_file_that_bulges_to_minus_z_is_turned_and_one_off_the_axis_is_moved(tmp_path):
    turned = BRepAlgoAPI.BRepAlgoAPI_Common(
        BRepPrimAPI.BRepPrimAPI_MakeCylinder(at(40, 0, -20), 25, 60).Shape(),
        BRepAlgoAPI.BRepAlgoAPI_Cut(
            BRepPrimAPI.BRepPrimAPI_MakeSphere(at(40, 0, 90), 90).Shape(),
            BRepPrimAPI.BRepPrimAPI_MakeSphere(at(40, 0, 3 + 120), 120).Shape(),
        ).Shape(),
    ).Shape()
    body = read_cad(saved(turned, tmp_path / "lens.step"))
    assert_sags(body, 90, 120)
    assert any("turned" in line for line in body.understood)
    assert any("moved" in line for line in body.understood)


@pytest.mark.parametrize(("major", "minor", "v"), [(80, 30, 0), (20, 100, 0), (100, 60, np.pi)])  # the last: a saddle
@pytest.mark.parametrize("angle", [0.0, 35.0, 90.0])
def test_a_torus_is_exact(tmp_path, major, minor, v, angle):
    axis = gp_Dir(np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0)
    ring = Geom_ToroidalSurface(gp_Ax3(gp_Pnt(0.5, 0.2, -3), axis, gp_Dir(0, 0, 1)), major, minor)
    body = read_cad(saved(MakeFace(ring, -0.1, 0.1, v - 0.2, v + 0.2, 1e-6).Face(), tmp_path / "ring.step"))
    sign = np.cos(v)
    wanted = surfaces.toric(sign / minor, 1 / (major + sign * minor), angle, decentration=(0.5, 0.2))
    mine, theirs = (surface_height(s, X / 9, Y / 9) - surface_height(s, 0, 0) for s in (body.front, wanted))
    assert mine == pytest.approx(theirs, abs=1e-9 if major > minor else 1e-6)
    assert ("exact" in body.understood[0]) == (major > minor)  # the others are written as surfaces of revolution


@pytest.mark.parametrize("kind", ["sphere", "asphere", "torus", "biconic", "spline"])
def test_a_written_lens_is_a_valid_solid_and_comes_back(tmp_path, lens_of, shapes, kind):
    from lensbench.formats.cad_writer import _solid

    front = shapes[kind][0]
    back = surfaces.toric(0.008, 0.011, 130.0, decentration=(0.4, 0.3), tilt=(-0.015, 0.01))
    lens = lens_of(front, back, thickness=6.0, outline=ellipse_outline(50, 40, (1.0, -2.0)))
    solid = _solid(lens)
    assert BRepCheck_Analyzer(solid).IsValid()
    path = tmp_path / "lens.step"
    path.write_bytes(step_text(lens))
    again = read_cad(path).lens(MATERIALS["CR-39"])
    x, y = (a.ravel() for a in lens.disc_points(8, 40)[:2])
    assert again.front_height(x, y) - again.front_height(0, 0) == pytest.approx(
        lens.front_height(x, y) - lens.front_height(0, 0), abs=2e-6
    )
    assert again.thickness(x, y) == pytest.approx(lens.thickness(x, y), abs=2e-6)
    angle = np.linspace(0, 6, 50)
    assert again.outline.radius(angle) == pytest.approx(lens.outline.radius(angle), abs=0.02)


def test_bad_files_say_so(tmp_path):
    for content in (b"", b"ISO-10303-21;\nnonsense", bytes(range(256)) * 20):
        path = tmp_path / "bad.step"
        path.write_bytes(content)
        with pytest.raises(InputError, match=r"bad\.step: not a STEP file that can be read"):
            read_cad(path)
    with pytest.raises(InputError, match="no such file"):
        read_cad(tmp_path / "none.step")
    wall = MakeFace(gp_Pln(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), -9, 9, -9, 9).Face()
    with pytest.raises(InputError, match="holds no face across z"):
        read_cad(saved(wall, tmp_path / "wall.step"))


def test_a_face_that_is_no_smooth_sag_is_refused(tmp_path):
    cone = BRepPrimAPI.BRepPrimAPI_MakeCone(at(0, 0, 0), 20, 0, 5).Shape()
    with pytest.raises(InputError, match="not a smooth sag along z"):
        read_cad(saved(cone, tmp_path / "cone.step"))
