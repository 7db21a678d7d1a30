"""Meshes: geometry where the optics says, arrays named with their units, files that VTK reads again."""

import json
from dataclasses import replace

import numpy as np
import pytest

import lensbench as lb
from lensbench.layers import EllipseLayer, LensMap, MapLayer, Request
from lensbench.optics import surfaces
from lensbench.optics.conventions import Status, mean_power, power_matrix
from lensbench.optics.foci import foci
from lensbench.optics.gaze import worn_pose
from lensbench.optics.lens import Lens, ellipse_outline
from lensbench.optics.materials import MATERIALS
from lensbench.scenes.scene import Scene, rectangle
from lensbench.workbench import run

pytest.importorskip("pyvista")
import pyvista as pv

from lensbench.views import meshes

WEAR = lb.Wear(pantoscopic_angle=0.14, face_form_angle=0.09)
MYOPE = lb.Wearer(lb.Eye(power_matrix(-3.0, -1.0, 20.0), accommodation=1.0), WEAR)
LENS = Lens(surfaces.sphere(90.0), surfaces.sphere(150.0), 5.0, MATERIALS["CR-39"], ellipse_outline(56, 44, (1.0, 2.0)))


@pytest.fixture(scope="module")
def power_map():
    return run(Request(LENS, MYOPE, MapLayer("mean_power", samples=61)))


def test_a_lens_is_three_blocks_with_its_powers():
    blocks = meshes.lens_blocks(LENS)
    assert blocks.keys() == ["front", "back", "edge"]
    front = blocks["front"]
    x, y, z = np.asarray(front.points).T
    assert z == pytest.approx(LENS.front_height(x, y), abs=1e-9)
    assert front["thickness_mm"] == pytest.approx(LENS.thickness(x, y), abs=1e-9)
    assert front["front_mean_power_D"] == pytest.approx(1000 * (LENS.index - 1) / 90, abs=1e-6)
    assert "as_worn_mean_power_D" not in front.point_data
    worn = meshes.lens_blocks(LENS, MYOPE, 400.0)["front"]
    assert worn_pose(LENS, WEAR).to_lens(worn.points) == pytest.approx(np.asarray(front.points), abs=1e-6)
    inner = LENS.outline.contains(1.001 * x, 1.001 * y)
    traced = lb.look_through(LENS, MYOPE, x[inner], y[inner]).as_worn_matrix(400.0)
    assert worn["as_worn_mean_power_D"][inner] == pytest.approx(mean_power(traced), abs=1e-9)


def test_a_map_lies_on_the_front_in_dioptres(power_map):
    mesh = meshes.map_mesh(LENS, power_map, WEAR)
    assert set(mesh.point_data) == {"mean_power_D", "Normals"}
    x, y, _ = worn_pose(LENS, WEAR).to_lens(mesh.points).T
    inner = LENS.outline.contains(1.05 * x, 1.05 * y)
    true = mean_power(lb.look_through(LENS, MYOPE, x[inner], y[inner]).as_worn_matrix())
    assert np.ptp(true) > 0.15
    assert mesh["mean_power_D"][inner] == pytest.approx(true, abs=2e-3)  # bilinear between samples 0.93 mm apart


def test_where_a_map_has_no_value_there_is_no_mesh(power_map):
    right_half = np.where(power_map.x > 5, power_map.values, np.nan)
    halved = replace(power_map, values=right_half, status=np.where(np.isnan(right_half), 7, 0).astype(np.int8))
    mesh, rest = meshes.map_and_rest(meshes.lens_mesh(LENS), halved)
    assert mesh.clean(point_merging=False).bounds[0] > 4
    assert mesh.area + rest.area == pytest.approx(meshes.lens_mesh(LENS).front.area, rel=1e-9)
    nowhere = replace(power_map, values=np.full_like(right_half, np.nan))
    assert meshes.map_mesh(LENS, nowhere).n_cells == 0


def test_an_axis_is_not_interpolated():
    axis = np.arange(-30.0, 31.0)
    x, _ = np.meshgrid(axis, axis)
    values = np.where(x > 0.5, 179.0, 1.0)
    lens_map = LensMap("axis", "As-worn axis", "deg", axis, axis, values, np.zeros(x.shape, dtype=np.int8))
    for mesh in (meshes.map_mesh(LENS, lens_map), meshes.map_solid(LENS, lens_map)):
        assert set(mesh.cell_data["axis_deg"]) == {1.0, 179.0}
        assert "axis_deg" not in mesh.point_data


def test_the_solid_is_the_body_of_the_lens(power_map):
    solid = meshes.map_solid(LENS, power_map)
    volume = solid.compute_cell_sizes()["Volume"]
    assert (volume > 0).all()
    assert volume.sum() == pytest.approx(LENS.weight() / LENS.material.density * 1000, rel=1e-3)
    half = solid.n_points // 2
    assert solid["mean_power_D"][:half] == pytest.approx(solid["mean_power_D"][half:], nan_ok=True)


def test_an_image_holds_the_maps_own_samples(power_map):
    image = meshes.map_image(power_map)
    assert image.bounds[:4] == pytest.approx([*power_map.x[[0, -1]], *power_map.y[[0, -1]]])
    for j, i in ((30, 20), (5, 40), (0, 0)):
        at = image.find_closest_point((power_map.x[i], power_map.y[j], 0.0))
        assert image["mean_power_D"][at] == pytest.approx(power_map.values[j, i], nan_ok=True)
        assert image["status"][at] == power_map.status[j, i]


def test_chief_rays_bend_where_the_field_says():
    field = lb.trace(LENS, MYOPE, lb.GazeGrid(9, 7, 0.9, 0.5))
    passed = np.flatnonzero(field.status == Status.OK)
    assert 0 < passed.size < 63
    lines = meshes.rays(field, 400.0)
    assert lines.cell_data["gaze"].tolist() == passed.tolist()
    points = np.asarray(lines.points).reshape(-1, 4, 3)
    assert points[:, 1] == pytest.approx(field.entry[passed])
    assert points[:, 2] == pytest.approx(field.origin[passed])
    assert np.linalg.norm(points[:, 3] - points[:, 2], axis=1) == pytest.approx(400.0)
    left, up = np.tan(np.radians(lines["azimuth_deg"])), np.tan(np.radians(lines["elevation_deg"]))
    seen = field.directions[passed]
    assert left == pytest.approx(seen[:, 0] / seen[:, 2])
    assert up == pytest.approx(seen[:, 1] / np.hypot(seen[:, 0], seen[:, 2]))
    assert meshes.rays(lb.trace(None, MYOPE, lb.GazeGrid(3, 3)), 400.0).n_points == 18


def test_focal_lines_stand_across_their_rays_at_their_distance():
    field = lb.trace(None, MYOPE, [[0.0, 0.0, 1.0], [0.3, -0.2, 1.0]])
    lines = meshes.focal_lines(field)
    assert lines.cell_data["gaze"].tolist() == [0, 0, 1, 1]
    assert lines.cell_data["focus"].tolist() == [0, 1, 0, 1]
    ends = np.asarray(lines.points).reshape(2, 2, 2, 3)
    middle = ends.mean(axis=2)
    away = np.linalg.norm(middle - field.origin[:, None], axis=-1)
    assert away == pytest.approx(lines["distance_mm"].reshape(2, 2))
    power = -1000 * np.linalg.inv(MYOPE.eye.pupil_refraction)
    assert away == pytest.approx(np.tile(np.linalg.eigvalsh(power), (2, 1)))
    run_of = ends[:, :, 1] - ends[:, :, 0]
    assert np.einsum("nki,ni->nk", run_of, field.direction) == pytest.approx(0, abs=1e-9)
    angle = np.degrees(np.arctan2(run_of[0, :, 1], run_of[0, :, 0])) % 180
    assert angle == pytest.approx([20, 110], abs=1e-6)


def test_virtual_foci_are_not_drawn():
    hyperope = replace(MYOPE, eye=lb.Eye(power_matrix(2.0)))
    field = lb.trace(None, hyperope, lb.GazeGrid(3, 3))
    assert meshes.focal_lines(field).n_cells == 0
    assert meshes.focal_lines(field, 3.0).n_cells == 18
    assert meshes.caustic(field)["first"].n_cells == 0


def test_a_caustic_holds_the_foci_and_the_astigmatism_between_them():
    field = lb.trace(None, MYOPE, lb.GazeGrid(5, 5))
    sheets = meshes.caustic(field)
    for k, name in enumerate(("first", "second")):
        expected = field.origin + foci(field).distance[:, k, None] * field.direction
        at = [sheets[name].find_closest_point(point) for point in expected]
        assert np.asarray(sheets[name].points)[at] == pytest.approx(expected)
        assert sheets[name]["distance_mm"][at] == pytest.approx(foci(field).distance[:, k])
        powers = np.linalg.eigvalsh(MYOPE.eye.pupil_refraction)
        assert sheets[name]["interval_D"] == pytest.approx(np.ptp(powers))
        assert sheets[name].n_cells == 16
    between = foci(field).distance[0].mean()
    assert meshes.caustic(field, farthest=between)["second"].n_cells == 0
    assert meshes.caustic(field, farthest=between)["first"].n_cells == 16
    with pytest.raises(ValueError, match="grid"):
        meshes.caustic(lb.trace(None, MYOPE, field.directions))


def test_real_rays_pass_through_the_focal_lines():
    myope = replace(MYOPE, eye=lb.Eye(power_matrix(-4.0)))
    field = lb.trace(None, myope, [[0.0, 0.0, 1.0]])
    lines = meshes.pupil_rays(field, 2000.0)
    points = np.asarray(lines.points).reshape(-1, 2, 3)
    assert len(points) > 20
    assert np.hypot(*(points[:, 0, :2]).T).max() <= myope.eye.pupil_diameter / 2
    focus = foci(field).distance[0, 0]
    along = (field.origin[0, 2] + focus - points[:, 0, 2]) / (points[:, 1, 2] - points[:, 0, 2])
    met = points[:, 0] + along[:, None] * (points[:, 1] - points[:, 0])
    assert np.hypot(*met[:, :2].T).max() < 1e-9
    through = meshes.pupil_rays(lb.trace(LENS, MYOPE, [[0.0, 0.0, 1.0]]), 500.0)
    assert len(np.asarray(through.points)) == 4 * through.n_cells


def test_ellipses_are_polygons_with_their_numbers():
    sheets = run(Request(LENS, MYOPE, EllipseLayer((270.0, 780.0), 6)))
    blocks = meshes.ellipses(sheets, MYOPE, 3.0)
    assert blocks.keys() == ["270 mm", "780 mm"]
    mesh, sheet = blocks["780 mm"], sheets[1]
    passed = meshes.passing(sheet)
    assert mesh.n_cells == passed.sum()
    assert mesh["semi_major_mm"] == pytest.approx(sheet.semi_major[passed])
    assert mesh["orientation_deg"] == pytest.approx(np.degrees(sheet.orientation[passed]))
    corners = np.asarray(mesh.points).reshape(mesh.n_cells, -1, 3)
    assert corners.mean(axis=1) == pytest.approx(sheet.centre[passed])
    reach = np.linalg.norm(corners - sheet.centre[passed][:, None], axis=2).max(axis=1)
    assert reach == pytest.approx(3 * sheet.semi_major[passed], rel=0.01)
    nothing = replace(sheet, status=np.full(36, Status.MISSED_BACK, dtype=np.int8))
    assert meshes.ellipse_mesh(nothing, MYOPE).n_cells == 0


@pytest.mark.usefixtures("gl")
def test_a_scene_keeps_its_places_and_its_paint():
    image = np.zeros((8, 8, 3), dtype=np.uint8)
    image[:4] = [255, 0, 0]  # its upper half is red
    part = rectangle("wall", (0, 0, 1000), (-300, 0, 0), (0, 300, 0), image)
    block = meshes.scene_blocks(Scene("room", (part,)))["wall"]
    assert np.asarray(block.points) == pytest.approx(part.points)
    assert block.n_cells == len(part.triangles)
    assert block.active_texture_coordinates == pytest.approx(part.uv)
    plotter = pv.Plotter(off_screen=True, window_size=(80, 80), lighting="none")
    plotter.add_mesh(block, texture=meshes.texture(part), lighting=False)
    plotter.camera_position = [(0, 0, -1000), (0, 0, 1000), (0, 1, 0)]
    picture = plotter.screenshot(return_img=True).astype(int)
    plotter.close()
    assert picture[32, 40].tolist() == [255, 0, 0]
    assert picture[48, 40].tolist() == [0, 0, 0]


@pytest.mark.parametrize("kind", ["vtp", "vtu", "vti"])
def test_a_file_is_read_again_as_it_was(power_map, tmp_path, kind):
    make = {"vtp": meshes.map_mesh, "vtu": meshes.map_solid, "vti": lambda _, found: meshes.map_image(found)}[kind]
    mesh = make(LENS, power_map)
    path = tmp_path / f"map.{kind}"
    path.write_bytes(meshes.vtk_file(mesh, {"lens": "R 1/2 µ", "distance": np.inf}))
    again = pv.read(path)
    assert type(again) is type(mesh)
    assert np.asarray(again.points) == pytest.approx(np.asarray(mesh.points), abs=1e-9)
    assert again["mean_power_D"] == pytest.approx(mesh["mean_power_D"], nan_ok=True)
    assert json.loads(again.field_data["about"][0]) == {"lens": "R 1/2 µ", "distance": "inf"}
