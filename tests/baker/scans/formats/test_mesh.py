"""Meshes in every format give points spread evenly over their surface, with their colours."""

import base64
import json
import os

import numpy as np
import pytest
import trimesh

from baker.errors import InputError
from baker.scans.fields import choose_fields
from baker.scans.formats import read_columns
from baker.scans.formats.mesh import MIN_POINTS, points_on_surface

SUFFIXES = (".obj", ".off", ".stl", ".glb", ".gltf", ".ply")


def read(path):
    return choose_fields(read_columns(path), path)


def painted_box():
    """A box of 2 by 4 by 8, red where x is low and blue where it is high."""
    box = trimesh.creation.box((2, 4, 8))
    high = box.vertices[:, 0] > 0
    box.visual.vertex_colors = np.where(high[:, None], [0, 0, 255, 255], [255, 0, 0, 255])
    return box


def write_mesh(mesh, path):
    if path.suffix == ".gltf":
        files = mesh.export(file_type="gltf")
        document = json.loads(files["model.gltf"])
        for buffer in document["buffers"]:
            content = base64.b64encode(files[buffer["uri"]]).decode()
            buffer["uri"] = f"data:application/octet-stream;base64,{content}"
        path.write_text(json.dumps(document))
    elif path.suffix == ".off":  # trimesh writes no colours into it
        rows = np.hstack([mesh.vertices, mesh.visual.vertex_colors]).tolist()
        faces = np.pad(mesh.faces, ((0, 0), (1, 0)), constant_values=3).tolist()
        lines = [
            f"COFF\n{len(rows)} {len(faces)} 0",
            *(" ".join(map(str, r)) for r in rows + faces),
        ]
        path.write_text("\n".join(lines))
    else:
        mesh.export(path)


@pytest.fixture(params=SUFFIXES)
def mesh_file(request, tmp_path):
    path = tmp_path / f"scan{request.param}"
    write_mesh(painted_box(), path)
    return path


def test_points_lie_evenly_on_the_surface(mesh_file):
    cloud = read(mesh_file)
    assert len(cloud) == MIN_POINTS
    distance = np.abs(np.abs(cloud.points) - [1, 2, 4])
    np.testing.assert_allclose(distance.min(axis=1), 0, atol=1e-6)
    # Each side has its share of the points, to one of 12 triangles' rounding.
    side = np.bincount(distance.argmin(axis=1), minlength=3) / len(cloud)
    np.testing.assert_allclose(side, np.array([32, 16, 8]) / 56, atol=1e-3)
    assert "12 triangles: 20000 points sampled evenly" in cloud.notes[0]


def test_colors_are_those_of_the_vertices(mesh_file):
    cloud = read(mesh_file)
    if mesh_file.suffix == ".stl":
        assert cloud.colors is None
        return
    is_blue = cloud.colors[:, 2] > 0
    np.testing.assert_array_equal(
        cloud.colors, np.where(is_blue[:, None], [0, 0, 255], [255, 0, 0])
    )
    ends = np.abs(cloud.points[:, 0]) == 1
    np.testing.assert_array_equal(is_blue[ends], cloud.points[ends, 0] > 0)
    assert np.median(cloud.points[is_blue, 0]) > 0.5 > -0.5 > np.median(cloud.points[~is_blue, 0])


@pytest.mark.parametrize("white", [np.float32(1), np.float64(255), np.uint8(255)])
def test_a_white_mesh_is_white(tmp_path, white):
    corners = [dict(zip("xyz", np.eye(3), strict=True))]
    corners += [dict.fromkeys(("red", "green", "blue"), np.full(3, white))]
    columns = points_on_surface(corners[0] | corners[1], [np.array([[0, 1, 2]])])
    assert (choose_fields(columns, tmp_path).colors == 255).all()


def test_the_same_points_each_time(mesh_file):
    first, second = (read_columns(mesh_file).values for _ in range(2))
    for name, values in first.items():
        assert values.tobytes() == second[name].tobytes()


def test_labels_are_those_of_the_nearest_corner(tmp_path):
    vertices = {
        "x": np.array([0.0, 10, 0]), "y": np.array([0.0, 0, 10]), "z": np.zeros(3),
        "label": np.array([4, 7, -2], np.int32),
    }  # fmt: skip
    columns = points_on_surface(vertices, [np.array([[0, 1, 2]])]).values
    corner = np.argmax([10 - columns["x"] - columns["y"], columns["x"], columns["y"]], axis=0)
    np.testing.assert_array_equal(columns["label"], vertices["label"][corner])
    assert columns["label"].dtype == np.int32


def test_faces_of_more_corners_are_fans(tmp_path):
    (tmp_path / "a.off").write_text(
        "OFF\n# a square\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"
    )
    points = read(tmp_path / "a.off").points
    np.testing.assert_allclose(points[:, :2].mean(axis=0), 0.5, atol=0.01)
    assert (points[:, :2].max(axis=0) > 0.98).all()


def test_an_obj_keeps_faces_of_any_number_of_corners(tmp_path):
    """One of five on a line that goes on, one of four, one of three."""
    corners = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1.5 0\nv 0 1 0\n"
    square = "v 0 0 9\nv 1 0 9\nv 1 1 9\nv 0 1 9\nvn 0 0 1\nf 6//1 7//1 8//1 9//1 # a square\n"
    (tmp_path / "a.obj").write_text(corners + "f -5 -4 \\\n -3 -2 -1\n" + square + "f 6 7 8\n")
    cloud = read(tmp_path / "a.obj")
    assert "6 triangles:" in cloud.notes[0]
    is_square = cloud.points[:, 2] > 5
    assert is_square.mean() == pytest.approx(1.5 / 4, abs=0.01)  # of the area, 2.5 and 1 and 0.5


def test_an_obj_far_from_the_origin_keeps_its_digits(tmp_path):
    (tmp_path / "a.obj").write_text(
        "v 364000.001 5620000.002 60\nv 364000.003 5620000.002 60\nv 364000.001 5620000.004 60\n"
        "f 1 2 3\n"
    )
    points = read(tmp_path / "a.obj").points
    np.testing.assert_allclose(np.ptp(points, axis=0), [0.002, 0.002, 0], atol=1e-4)


@pytest.mark.parametrize("parts", [[{"uri": "a.bin"}], {"bin": {"uri": "../a.bin"}}, [3], 7, [{}]])
def test_a_gltf_of_any_layout_is_refused_in_a_sentence(tmp_path, parts):
    (tmp_path / "a.gltf").write_text(json.dumps({"asset": {"version": "2.0"}, "buffers": parts}))
    with pytest.raises(InputError, match=r"a\.gltf' (holds no mesh|is not a valid GLTF|refers to)"):
        read(tmp_path / "a.gltf")


def test_faces_without_area_leave_the_vertices(tmp_path):
    vertices = {axis: np.arange(4.0) for axis in "xyz"}
    columns = points_on_surface(vertices, [np.array([[0, 0, 0], [0, 1, 2]])])
    assert len(columns.values["x"]) == 4


@pytest.mark.parametrize("index", [4, -1, 2**31 - 1])
def test_corners_that_are_no_vertices_are_refused(tmp_path, index):
    (tmp_path / "a.off").write_text(f"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 {index}\n")
    with pytest.raises(InputError, match=r"a\.off' has faces with corners that are not among"):
        read(tmp_path / "a.off")


@pytest.mark.parametrize(
    ("name", "content"), [("a.obj", "v 0 0 0\nv 1 1 1\n"), ("a.off", "OFF\n1 0 0\n0 0 0\n")]
)
def test_a_mesh_without_faces_says_what_to_export(tmp_path, name, content):
    (tmp_path / name).write_text(content)
    with pytest.raises(InputError, match=r"holds no mesh .* points without faces"):
        read(tmp_path / name)


def test_parts_of_a_scene_stand_where_they_are_put(tmp_path):
    scene = trimesh.Scene()
    box = trimesh.creation.box((1, 1, 1))
    scene.add_geometry(box)
    scene.add_geometry(box, transform=trimesh.transformations.translation_matrix([10, 0, 0]))
    scene.export(tmp_path / "a.glb")
    points = read(tmp_path / "a.glb").points
    assert points[:, 0].min() == pytest.approx(-0.5)
    assert points[:, 0].max() == pytest.approx(10.5)


def test_materials_of_an_obj_are_not_opened(tmp_path):
    """A pipe that nobody writes to would be waited for."""
    folder = tmp_path / "scans"
    folder.mkdir()
    for pipe in (tmp_path / "pipe.mtl", folder / "pipe.mtl"):
        os.mkfifo(pipe)
    triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"
    for name in ("../pipe.mtl", "pipe.mtl", f"../../{tmp_path.name}/pipe.mtl"):
        (folder / "a.obj").write_text(f"mtllib {name}\n{triangle}")
        assert len(read(folder / "a.obj")) == MIN_POINTS


@pytest.mark.parametrize("suffix", [".gltf", ".glb"])
def test_a_gltf_that_refers_to_other_files_is_refused(tmp_path, suffix):
    write_mesh(painted_box(), tmp_path / f"a{suffix}")
    content = (tmp_path / f"a{suffix}").read_bytes()
    start, end = (
        (0, len(content)) if suffix == ".gltf" else (20, 20 + content[12] + 256 * content[13])
    )
    document = json.loads(content[start:end])
    document["images"] = [{"uri": "leaf.png"}]
    changed = json.dumps(document).encode()
    size = len(changed).to_bytes(4, "little")
    head = content[:12] + size + content[16:20] if start else b""
    (tmp_path / f"a{suffix}").write_bytes(head + changed + content[end:])
    with pytest.raises(InputError, match=r"refers to other files; export it as one GLB"):
        read(tmp_path / f"a{suffix}")
