"""A small sound file of every kind that a bake reads, by the kind's name.

name, make = SOUND["ply binary"]
(folder / name).write_bytes(make())
"""

from __future__ import annotations

import base64
import gzip
import io
import json
import tempfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Columns = dict[str, NDArray[Any]]


def _columns(count: int = 12) -> Columns:
    random = np.random.default_rng(0)
    columns: Columns = {axis: random.integers(-50, 50, count) / 4.0 for axis in "xyz"}
    for name in ("red", "green", "blue"):
        columns[name] = random.integers(0, 256, count).astype(np.uint8)
    columns["label"] = random.integers(0, 4, count).astype(np.int32)
    return columns


def _rows(columns: Columns, delimiter: str = " ") -> str:
    values = zip(*(column.tolist() for column in columns.values()), strict=True)
    return "".join(delimiter.join(map(str, row)) + "\n" for row in values)


def _ply(form: str, lists: str = "after") -> bytes:
    """A PLY with a face; its lists come `after` the vertices, `before` or `inside` them."""
    columns = _columns()
    order = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(form, "<")
    names = {"f": "double", "u": "uchar", "i": "int"}
    vertex = f"element vertex {len(columns['x'])}\n" + "".join(
        f"property {names[values.dtype.kind]} {name}\n" for name, values in columns.items()
    )
    if lists == "inside":
        vertex += "property list uchar int neighbors\n"
    face = "element face 1\nproperty list uchar int vertex_indices\n"
    record = [(name, values.dtype.newbyteorder(order)) for name, values in columns.items()]
    body = np.zeros(len(columns["x"]), record)
    for name, values in columns.items():
        body[name] = values
    binary = bytes([3]) + np.array([0, 1, 2], order + "i4").tobytes()
    points = _rows(columns).encode() if form == "ascii" else body.tobytes()
    if lists == "inside":  # an empty list a vertex
        points = b"".join(row.tobytes() + b"\0" for row in body)
    faces = b"3 0 1 2\n" if form == "ascii" else binary
    text, parts = (
        (face + vertex, faces + points)
        if lists == "before"
        else (
            vertex + face,
            points + faces,
        )
    )
    return f"ply\nformat {form} 1.0\ncomment made\n{text}end_header\n".encode() + parts


def _pcd(form: str) -> bytes:
    columns = _columns()
    binary = pcd_bytes(columns)
    header = binary.split(b"binary\n")[0]
    if form == "ascii":
        return header + b"ascii\n" + _rows(columns).encode()
    if form == "binary":
        return binary
    body = b"".join(np.ascontiguousarray(values).tobytes() for values in columns.values())
    packed = lzf_literals(body)
    sizes = np.array([len(packed), len(body)], "<u4").tobytes()
    return header + b"binary_compressed\n" + sizes + packed


def pcd_bytes(columns: Columns) -> bytes:
    """Columns of any types as a binary PCD."""
    record = np.dtype([(name, values.dtype) for name, values in columns.items()])
    body = np.zeros(len(columns["x"]), record)
    for name, values in columns.items():
        body[name] = values
    kinds = [record[name] for name in columns]
    header = (
        f"VERSION 0.7\nFIELDS {' '.join(columns)}\n"
        f"SIZE {' '.join(str(kind.itemsize) for kind in kinds)}\n"
        f"TYPE {' '.join(kind.kind.upper() for kind in kinds)}\n"
        f"COUNT {' '.join('1' for _ in kinds)}\nWIDTH {len(body)}\nHEIGHT 1\n"
        f"POINTS {len(body)}\nDATA binary\n"
    )
    return header.encode() + body.tobytes()


def lzf_literals(data: bytes) -> bytes:
    """Valid LZF that compresses nothing: runs of literal bytes."""
    runs = [data[start : start + 32] for start in range(0, len(data), 32)]
    return b"".join(bytes([len(run) - 1]) + run for run in runs)


def _las(suffix: str, version: str, point_format: int) -> bytes:
    import laspy

    columns = _columns()
    header = laspy.LasHeader(point_format=point_format, version=version)
    header.scales = np.full(3, 1e-3)
    file = laspy.LasData(header)
    file.x, file.y, file.z = columns["x"], columns["y"], columns["z"]
    file.add_extra_dim(laspy.ExtraBytesParams("label", "int32"))
    file.label = columns["label"]
    sink = io.BytesIO()
    file.write(sink, do_compress=suffix == ".laz")
    return sink.getvalue()


def _mesh(form: str) -> bytes:
    """A sphere of 80 triangles with coloured vertices."""
    import trimesh

    sphere = trimesh.creation.icosphere(1)
    colors = np.random.default_rng(0).integers(0, 256, (len(sphere.vertices), 4))
    sphere.visual.vertex_colors = colors.astype(np.uint8)
    if form == "coff":
        points = _rows(dict(enumerate(sphere.vertices.T)))
        faces = dict(enumerate(sphere.faces.T))
        rows = [
            f"{row} {r} {g} {b}"
            for row, (r, g, b, _) in zip(points.splitlines(), colors, strict=True)
        ]
        triangles = _rows({"count": np.full(len(sphere.faces), 3), **faces})
        return "\n".join([f"COFF\n{len(rows)} {len(sphere.faces)} 0", *rows, triangles]).encode()
    if form == "gltf":
        files = sphere.export(file_type="gltf")
        document = json.loads(files["model.gltf"])
        for buffer in document["buffers"]:
            content = base64.b64encode(files[buffer["uri"]]).decode()
            buffer["uri"] = f"data:application/octet-stream;base64,{content}"
        return json.dumps(document).encode()
    options = (
        {"file_type": "ply", "encoding": "ascii"} if form == "ply_ascii" else {"file_type": form}
    )
    content = sphere.export(**options)
    return content.encode() if isinstance(content, str) else content


def _e57() -> bytes:
    import pye57

    columns = _columns()
    names = {"x": "cartesianX", "y": "cartesianY", "z": "cartesianZ"}
    names |= {"red": "colorRed", "green": "colorGreen", "blue": "colorBlue"}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.e57")
        file = pye57.E57(str(path), mode="w")
        file.write_scan_raw({names[name]: columns[name] for name in names})
        file.close()
        return path.read_bytes()


def _arrays(save: Callable[..., None]) -> bytes:
    columns = _columns()
    sink = io.BytesIO()
    points = np.stack([columns[axis] for axis in "xyz"], axis=1)
    if save is np.save:
        save(sink, np.rec.fromarrays(list(columns.values()), names=list(columns)))
    else:
        colors = np.stack([columns[name] for name in ("red", "green", "blue")], axis=1)
        save(sink, points=points, colors=colors, labels=columns["label"])
    return sink.getvalue()


def image(kind: str, form: str = "PNG") -> bytes:
    from PIL import Image

    inside = np.zeros((12, 16), bool)
    inside[3:9, 4:12] = True
    pixels = {
        "color": np.where(inside[..., None], [10, 200, 30], [90, 70, 50]).astype(np.uint8),
        "depth": np.where(inside, 360, 400).astype(np.uint16),
        "label": np.where(inside, 3, 0).astype(np.uint8),
    }[kind]
    sink = io.BytesIO()
    Image.fromarray(pixels).save(sink, form)
    return sink.getvalue()


CAMERA = b"""fx = 100.0
fy = 120.0
cx = 8
cy = 6.5
width = 16
height = 12
depth_unit = 1
crop = [0, 0]
ground = 500.0
background = 0
per_day = 6
[images]
color = "rgb_*.png"
"""

CORRECTIONS = b"""[[correction]]
kind = "name"
name = "leaf 3"
places = [{ scan = "a.xyz", point = [1, 2.5, -3e2], organ = "leaf 4" }]
[[correction]]
kind = "same"
places = [
    { scan = "a.xyz", point = [1, 2, 3] },
    { scan = "b.xyz", point = [1, 2, 4] },
]
"""

CAMERA_PATH = b"""{"camera_path": 1, "up": "z", "keys": [
 {"day": 0, "target": [0, 0, 1.5], "distance": 10, "yaw": 0, "pitch": 10, "field_of_view": 40},
 {"day": 2.5, "target": [0, 1, 0], "distance": 5, "yaw": 350, "pitch": -10, "field_of_view": 30}
]}"""

SETTINGS = b'{"size": [1280, 800], "panel": true, "ground": "light", "guides": false}'

SOUND: dict[str, tuple[str, Callable[[], bytes]]] = {
    "ply ascii": ("s.ply", lambda: _ply("ascii")),
    "ply binary": ("s.ply", lambda: _ply("binary_little_endian")),
    "ply big": ("s.ply", lambda: _ply("binary_big_endian")),
    "ply ascii, lists before": ("s.ply", lambda: _ply("ascii", "before")),
    "ply binary, lists before": ("s.ply", lambda: _ply("binary_little_endian", "before")),
    "ply binary, lists inside": ("s.ply", lambda: _ply("binary_little_endian", "inside")),
    "pcd ascii": ("s.pcd", lambda: _pcd("ascii")),
    "pcd binary": ("s.pcd", lambda: _pcd("binary")),
    "pcd compressed": ("s.pcd", lambda: _pcd("compressed")),
    "xyz": ("s.xyz", lambda: _rows(_columns()).encode()),
    "txt": ("s.txt", lambda: b"# a comment\n" + _rows(_columns(), "\t").encode()),
    "csv": (
        "s.csv",
        lambda: (",".join(_columns()) + "\n" + _rows(_columns(), ",")).encode(),
    ),
    "asc": (
        "s.asc",
        lambda: ("//" + ";".join(_columns()) + "\n" + _rows(_columns(), ";")).encode(),
    ),
    "pts": ("s.pts", lambda: ("12\n" + _rows(_columns())).encode()),
    "ply mesh": ("s.ply", lambda: _mesh("ply")),
    "ply mesh ascii": ("s.ply", lambda: _mesh("ply_ascii")),
    "obj": ("s.obj", lambda: _mesh("obj")),
    "stl ascii": ("s.stl", lambda: _mesh("stl_ascii")),
    "stl binary": ("s.stl", lambda: _mesh("stl")),
    "off": ("s.off", lambda: _mesh("off")),
    "off with colors": ("s.off", lambda: _mesh("coff")),
    "glb": ("s.glb", lambda: _mesh("glb")),
    "gltf": ("s.gltf", lambda: _mesh("gltf")),
    "npy": ("s.npy", lambda: _arrays(np.save)),
    "npz": ("s.npz", lambda: _arrays(np.savez)),
    "npz compressed": ("s.npz", lambda: _arrays(np.savez_compressed)),
    "gz of xyz": ("s.xyz.gz", lambda: gzip.compress(_rows(_columns()).encode(), mtime=0)),
    "gz of ply": ("s.ply.gz", lambda: gzip.compress(_ply("binary_little_endian"), mtime=0)),
    "las 1.2": ("s.las", lambda: _las(".las", "1.2", 3)),
    "las 1.4": ("s.las", lambda: _las(".las", "1.4", 7)),
    "laz 1.2": ("s.laz", lambda: _las(".laz", "1.2", 3)),
    "laz 1.4": ("s.laz", lambda: _las(".laz", "1.4", 7)),
    "times": ("times.csv", lambda: b"name,day\na.xyz,2020-03-08\nb.xyz,2020-03-09T14:30\n"),
    "days": ("times.txt", lambda: b"a.xyz 1.5\nb.xyz 3\n"),
    "corrections": ("plant.corrections.toml", lambda: CORRECTIONS),
    "view path": ("path.json", lambda: CAMERA_PATH),
    "settings": ("plant-growth-clips/window.json", lambda: SETTINGS),
    "camera": ("camera.toml", lambda: CAMERA),
    "camera json": (
        "camera.json",
        lambda: b'{"fx": 100.0, "fy": 120, "cx": 8, "cy": 6.5, "crop": [0, 0], "images": {}}',
    ),
    "color": ("rgb_000_00.png", lambda: image("color")),
    "depth": ("depth_000_00.png", lambda: image("depth")),
    "label": ("label_000_00.png", lambda: image("label")),
    "depth tif": ("depth_000_00.png", lambda: image("depth", "TIFF")),
    "color jpg": ("rgb_000_00.png", lambda: image("color", "JPEG")),
}


if find_spec("pye57"):  # which has no wheel for every machine
    SOUND["e57"] = ("s.e57", _e57)
