"""Meshes of every kind stand in true millimetres before the eye, keep their colours and textures, and bad ones are refused."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from lensbench.cli import main
from lensbench.errors import InputError
from lensbench.formats.scene_file import find_scene
from lensbench.scenes.cast import first_hit
from lensbench.scenes.mesh_file import Placing

OpenEXR = pytest.importorskip("OpenEXR")

QUARTERS = np.zeros((64, 64, 3), np.uint8)  # red and green above, blue and white below
QUARTERS[:32, :32], QUARTERS[:32, 32:], QUARTERS[32:, :32], QUARTERS[32:, 32:] = (
    (255, 0, 0),
    (0, 255, 0),
    (0, 0, 255),
    255,
)
PLACE = {"eye": (1.0, 1.5, 4.0), "ahead": (0.0, 0.0, -1.0)}


def board(width=1.0, height=0.5, texture=QUARTERS, tiles=1.0):
    """A board in the plane z = 0 about (1, 1.5), facing +z, textured: u to +x, v up."""
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    points = np.column_stack([corner * [width, height] + [1.0, 1.5], np.zeros(4)])
    mesh = trimesh.Trimesh(points, [[0, 1, 2], [0, 2, 3]], process=False)
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.fromarray(texture))
    mesh.visual = trimesh.visual.TextureVisuals(uv=(corner + 0.5) * tiles, material=material)
    return mesh


def colour_at(scene, direction):
    """The texture's colour where a ray from the origin meets the scene."""
    distance = first_hit(scene, [[0, 0, 0]], [direction])[0]
    hit = distance * np.asarray(direction) / np.linalg.norm(direction)
    for part in scene.parts:
        corner = part.points[part.triangles]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        square = np.einsum("nj,nj->n", normal, normal)
        share = [
            np.einsum(
                "nj,nj->n",
                np.cross(corner[:, (k + 2) % 3] - corner[:, (k + 1) % 3], hit - corner[:, (k + 1) % 3]),
                normal,
            )
            / square
            for k in range(3)
        ]
        off = np.abs(np.einsum("nj,nj->n", hit - corner[:, 0], normal)) / np.sqrt(square)
        held = np.flatnonzero((np.min(share, axis=0) > -1e-3) & (off < 1.0))
        if held.size:
            uv = np.array(share)[:, held[0]] @ part.uv[part.triangles[held[0]]]
            height, width = part.image.shape[:2]
            x, y = min(int(uv[0] * width), width - 1), min(int((1 - uv[1]) * height), height - 1)
            return tuple(int(c) for c in part.image[y, x])
    raise AssertionError("nothing is met")


@pytest.mark.parametrize("kind", ["glb", "obj"])
def test_a_textured_board_stands_in_millimetres_the_right_way_round(tmp_path, kind):
    path = tmp_path / f"board.{kind}"
    board().export(path)
    scene = find_scene(str(path), "m", **PLACE)
    points = np.concatenate([part.points for part in scene.parts])
    assert points.min(axis=0) == pytest.approx([-500, -250, 4000], abs=0.01)
    assert points.max(axis=0) == pytest.approx([500, 250, 4000], abs=0.01)
    assert colour_at(scene, [300, 100, 4000]) == (255, 0, 0)  # up on the wearer's left
    assert colour_at(scene, [-300, 100, 4000]) == (0, 255, 0)
    assert colour_at(scene, [300, -100, 4000]) == (0, 0, 255)
    assert colour_at(scene, [-300, -100, 4000]) == (255, 255, 255)


def test_units_eye_and_directions():
    placing = Placing("ft", (1.0, 2.0, 3.0), (2.0, 0.0, 0.0), (0.0, 0.0, 5.0))
    assert placing.points([[11.0, 2.0, 3.0], [1.0, 2.0, 4.0], [1.0, 3.0, 3.0]]) == pytest.approx(
        np.array([[0, 0, 3048.0], [0, 304.8, 0], [304.8, 0, 0]])
    )
    with pytest.raises(InputError, match="two different directions"):
        Placing("m", (0, 0, 0), (0, 3, 0)).frame()
    with pytest.raises(InputError, match="unit 'parsec' is none of mm"):
        Placing("parsec", (0, 0, 0), (0, 0, 1)).points([[0, 0, 0]])


def test_gltf_nodes_are_placed_and_base_colours_kept(tmp_path):
    scene = trimesh.Scene()
    block = trimesh.creation.box((1, 1, 1))
    block.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(baseColorFactor=[0.0, 0.5, 0.0, 1.0])
    )
    scene.add_geometry(block, transform=trimesh.transformations.translation_matrix([1.0, 1.5, -3.0]))
    scene.export(tmp_path / "block.glb")
    found = find_scene(str(tmp_path / "block.glb"), **PLACE)
    assert first_hit(found, [[0, 0, 0]], [[0, 0, 1.0]])[0] == pytest.approx(6500, rel=1e-4)
    red, green, blue = colour_at(found, [20, 30, 6500])
    assert (red, blue) == (0, 0)
    assert 130 < green <= 255  # linear 0.5 is sRGB 188, in the light that falls on it


@pytest.mark.parametrize("kind", ["ply", "glb"])
def test_vertex_colours_run_between_the_corners(tmp_path, kind):
    mesh = board()
    mesh.visual = trimesh.visual.ColorVisuals(
        mesh, vertex_colors=[[255, 0, 0, 255], [0, 0, 255, 255], [0, 0, 255, 255], [255, 0, 0, 255]]
    )
    mesh.export(tmp_path / f"board.{kind}")
    scene = find_scene(str(tmp_path / f"board.{kind}"), "m", **PLACE)
    across = np.array([colour_at(scene, [x, 30, 4000]) for x in (430, 200, -200, -430)])
    assert (np.diff(across[:, 0]) < 0).all()
    assert (np.diff(across[:, 2]) > 0).all()
    assert across[:, 1].max() == 0


def test_stl_without_colours_is_shaded(tmp_path):
    trimesh.creation.box((1, 1, 1)).apply_translation([1.0, 1.5, 0.0]).export(tmp_path / "box.stl")
    scene = find_scene(str(tmp_path / "box.stl"), "m", eye=(1.7, 2.6, 3.0), ahead=(-0.7, -1.1, -3.0))
    front = colour_at(scene, Placing("m", (1.7, 2.6, 3.0), (-0.7, -1.1, -3.0)).points([[1.0, 1.5, 0.5]])[0])
    top = colour_at(scene, Placing("m", (1.7, 2.6, 3.0), (-0.7, -1.1, -3.0)).points([[1.0, 2.0, 0.1]])[0])
    assert abs(front[0] - top[0]) > 15
    assert max(front) - min(front) <= 6  # grey


def test_a_texture_that_repeats_is_laid_out(tmp_path):
    board(tiles=2.0).export(tmp_path / "board.glb")
    scene = find_scene(str(tmp_path / "board.glb"), **PLACE)
    assert scene.parts[0].uv.max() <= 1
    assert colour_at(scene, [450, 220, 4000]) == (255, 0, 0)
    assert colour_at(scene, [-50, 220, 4000]) == (255, 0, 0)
    board(tiles=70.0).export(tmp_path / "many.glb")
    with pytest.raises(InputError, match="repeated 70 times; 64 times are the most"):
        find_scene(str(tmp_path / "many.glb"), **PLACE)


def test_glass_is_left_out(tmp_path):
    scene = trimesh.Scene([board()])
    pane = trimesh.creation.box((2, 2, 0.01)).apply_translation([1, 1.5, 2])
    material = trimesh.visual.material.PBRMaterial(baseColorFactor=[1.0, 1.0, 1.0, 0.2], alphaMode="BLEND")
    pane.visual = trimesh.visual.TextureVisuals(material=material)
    scene.add_geometry(pane)
    scene.export(tmp_path / "pane.glb")
    found = find_scene(str(tmp_path / "pane.glb"), **PLACE)
    assert first_hit(found, [[0, 0, 0]], [[0, 0, 1.0]])[0] == pytest.approx(4000, rel=1e-4)


# ---- scene files ----


def scene_file(folder: Path, extra: str = "", meshes: str = '["board.glb"]') -> Path:
    board().export(folder / "board.glb")
    path = folder / "scene.toml"
    path.write_text(
        f'format = "lensbench-scene/1"\nname = "my board"\nmeshes = {meshes}\nunit = "m"\n'
        f"eye = [1, 1.5, 4]\nahead = [0, 0, -1]\n{extra}",
        encoding="utf-8",
    )
    return path


def lat_long(path: Path, width=64, light=None):
    """Ahead red, left green, right blue, behind grey; the upper half twice as bright."""
    light = np.zeros((width // 2, width, 3), np.float32) if light is None else light
    quarter = width // 8
    light[:, :] = 0.1
    light[:, 3 * quarter : 5 * quarter] = (0.4, 0, 0)
    light[:, quarter : 3 * quarter] = (0, 0.4, 0)
    light[:, 5 * quarter : 7 * quarter] = (0, 0, 0.4)
    light[: width // 4] *= 2
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": OpenEXR.Channel(light)}).write(str(path))


def sky_colour(scene, direction):
    part = scene.sky
    seen = part.points / np.linalg.norm(part.points, axis=1, keepdims=True)
    u, v = part.uv[np.argmax(seen @ (np.asarray(direction) / np.linalg.norm(direction)))]
    height, width = part.image.shape[:2]
    return part.image[min(int((1 - v) * height), height - 1), min(int(u * width), width - 1)]


def test_a_scene_file_with_looks_background_and_environment(tmp_path):
    lat_long(tmp_path / "sky.exr")
    extra = (
        'background = [1, 2, 3]\n[environment]\nfile = "sky.exr"\nexposure = 1.0\n[looks]\ncorner = [0.5, 1.25, 0.0]\n'
    )
    scene = find_scene(str(scene_file(tmp_path, extra)))
    assert (scene.name, scene.background) == ("my board", (1, 2, 3))
    assert scene.looks["corner"].target == pytest.approx((500, -250, 4000))
    ahead, left, right = (sky_colour(scene, d) for d in ([0, -0.2, 1], [1, -0.2, 0.1], [-1, -0.2, 0.1]))
    assert [int(np.argmax(c)) for c in (ahead, left, right)] == [0, 1, 2]
    assert ahead[0] == 231  # linear 0.4 one stop up is 0.8
    assert sky_colour(scene, [0, 0.2, 1])[0] == 255  # the upper half is brighter, and cut off at 1


def test_an_environment_can_stand_alone_and_a_file_is_checked(tmp_path, capsys):
    lat_long(tmp_path / "sky.exr")
    path = scene_file(tmp_path, '[environment]\nfile = "sky.exr"\n', "[]")
    scene = find_scene(str(path))
    assert scene.drawn == (scene.sky,)
    assert np.isinf(first_hit(scene, [[0, 0, 0]], [[0, 0, 1.0]])).all()
    assert main(["check", str(scene_file(tmp_path, "[looks]\nmiddle = [1, 1.5, 0]\n"))]) == 0
    assert "4013 mm away, elevation +0.0" in capsys.readouterr().out
    assert main(["map", str(path)]) == 2
    assert "holds a scene, not a lens" in capsys.readouterr().err


def test_the_environments_heading_turns_the_head_to_the_right(tmp_path):
    lat_long(tmp_path / "sky.exr")
    scene = find_scene(str(scene_file(tmp_path, '[environment]\nfile = "sky.exr"\nheading = 90.0\n')))
    assert np.argmax(sky_colour(scene, [0, -0.2, 1])) == 2  # what was on the right is ahead


@pytest.mark.parametrize(
    ("extra", "meshes", "said"),
    [
        ("", "[]", "give meshes, or an environment"),
        ("", '["../board.glb"]', r"meshes\[0\]: '../board.glb' must lie in the scene file's folder"),
        ("", '["/etc/passwd.stl"]', "must lie in the scene file's folder"),
        ("", '["gone.glb"]', "gone.glb: no such file"),
        ("", '["board.fbx"]', "is no mesh that can be read; there are .glb"),
        ("light = 3\n", '["board.glb"]', "unknown key 'light'"),
        ("[looks]\nback = [1, 1.5, 9]\n", '["board.glb"]', "looks.back: lies behind the eye"),
        ('[environment]\nfile = "scene.toml"\n', '["board.glb"]', "cannot be read as OpenEXR"),
    ],
)
def test_bad_scene_files_are_said_in_one_sentence(tmp_path, extra, meshes, said):
    with pytest.raises(InputError, match=said):
        find_scene(str(scene_file(tmp_path, extra, meshes)))


def test_bad_meshes_are_said_in_one_sentence(tmp_path):
    broken, empty = tmp_path / "broken.glb", tmp_path / "empty.ply"
    broken.write_bytes(b"glTF nonsense")
    trimesh.PointCloud(np.random.default_rng(0).random((9, 3))).export(empty)
    with pytest.raises(InputError, match="not a mesh that can be read"):
        find_scene(str(broken), **PLACE)
    with pytest.raises(InputError, match="shows nothing"):
        find_scene(str(empty), "m", **PLACE)
    board().export(tmp_path / "board.obj")
    with pytest.raises(InputError, match="a mesh needs its unit and the wearer's place"):
        find_scene(str(tmp_path / "board.obj"), **PLACE)
    with pytest.raises(InputError, match="nothing of it stands before the eye"):
        find_scene(str(tmp_path / "board.obj"), "m", eye=(1, 1.5, 4), ahead=(0, 0, 1))
    with pytest.raises(InputError, match="says its unit and the wearer's place itself"):
        find_scene(str(scene_file(tmp_path)), "m")


def test_an_environment_must_be_twice_as_wide_as_high(tmp_path):
    OpenEXR.File({}, {"RGB": OpenEXR.Channel(np.zeros((8, 8, 3), np.float32))}).write(str(tmp_path / "sky.exr"))
    with pytest.raises(InputError, match="is 8 x 8; an equirectangular environment is twice as wide as high"):
        find_scene(str(scene_file(tmp_path, '[environment]\nfile = "sky.exr"\n')))
    OpenEXR.File({}, {"Z": OpenEXR.Channel(np.zeros((8, 16), np.float32))}).write(str(tmp_path / "sky.exr"))
    with pytest.raises(InputError, match="holds no channels R, G and B"):
        find_scene(str(scene_file(tmp_path, '[environment]\nfile = "sky.exr"\n')))


def test_the_command_line_lists_a_scenes_looks(tmp_path, capsys):
    assert main(["scenes", "--scene", str(scene_file(tmp_path, "[looks]\nmiddle = [1, 1.5, 0]\n")), "--json"]) == 0
    (fact,) = json.loads(capsys.readouterr().out)
    assert fact["looks"]["middle"]["distance"] == pytest.approx(4013)  # from the cornea
    assert main(["scenes", "--scene", "stairs"]) == 0
    assert "third step" in capsys.readouterr().out


@pytest.mark.parametrize("inside_out", [False, True])
def test_a_room_is_lit_inside_whichever_way_its_triangles_turn(tmp_path, inside_out):
    room = trimesh.creation.box((4, 3, 6))
    if inside_out:
        room.invert()
    room.export(tmp_path / "room.stl")
    scene = find_scene(str(tmp_path / "room.stl"), "m", eye=(0, 0, 2), ahead=(0, 0, -1))
    floor, ceiling, wall = (colour_at(scene, d)[0] for d in ([0, -1.4, 3], [0, 1.4, 3], [0.3, 0.2, 5]))
    assert ceiling < floor  # more light comes from above
    assert wall > 60


def test_no_file_outside_the_meshs_folder_is_read(tmp_path):
    Image.fromarray(np.full((8, 8, 3), (255, 0, 0), np.uint8)).save(tmp_path / "outside.png")
    folder = tmp_path / "inside"
    folder.mkdir()
    (folder / "m.mtl").write_text("newmtl a\nKd 0 1 0\nmap_Kd ../outside.png\n")
    corners = "v 0 0 0\nv 2 0 0\nv 0 3 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
    (folder / "m.obj").write_text(f"mtllib m.mtl\n{corners}usemtl a\nf 1/1 2/2 3/3\n")
    scene = find_scene(str(folder / "m.obj"), "m", eye=(0.5, 0.5, 4.0), ahead=(0.0, 0.0, -1.0))
    red, green, _ = colour_at(scene, [0, 0, 4000])
    assert (red, green > 100) == (0, True)
    board().export(folder / "b.gltf")
    text = (folder / "b.gltf").read_text()
    outside = {"uri": "../outside.png"}
    tree = json.loads(text)
    tree["buffers"][0] |= outside
    (folder / "b.gltf").write_text(json.dumps(tree))
    with pytest.raises(InputError, match="not a mesh that can be read"):
        find_scene(str(folder / "b.gltf"), **PLACE)
