"""Damaged files of every kind that a bake reads, and what their readers owe them.

A case is plain data, so that hypothesis can draw it and its text can be run again:

    check_file(File("ply binary", (("cut", 3), ("flip bits", 7))), folder)

`python -m tests.baker.fuzz_scans` draws thousands of them; tests/baker/test_hostile_files.py a few.
"""

from __future__ import annotations

import base64
import gzip
import io
import json
import re
import tempfile
import tracemalloc
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.baker.hostile_series import write_pcd

ROOM, TIMES = 48 << 20, 40  # bytes that reading may take, and how many more for each of the file's

Random = np.random.Generator
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
    path = io.BytesIO()

    class Sink:
        """What `write_pcd` writes to."""

        def write_bytes(self, content: bytes) -> None:
            path.write(content)

    write_pcd(Sink(), columns)  # type: ignore[arg-type]
    header = path.getvalue().split(b"binary\n")[0]
    if form == "ascii":
        return header + b"ascii\n" + _rows(columns).encode()
    if form == "binary":
        return path.getvalue()
    body = b"".join(np.ascontiguousarray(values).tobytes() for values in columns.values())
    packed = lzf_literals(body)
    sizes = np.array([len(packed), len(body)], "<u4").tobytes()
    return header + b"binary_compressed\n" + sizes + packed


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


def _image(kind: str, form: str = "PNG") -> bytes:
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
depth_unit = "1 mm"
crop = [0, 0]
ground = 500.0
background = 0
per_day = 6
[images]
color = "rgb_*.png"
[repair]
ring = 1
band = 6
jump = 2.0
"""

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
    "camera": ("camera.toml", lambda: CAMERA),
    "camera json": (
        "camera.json",
        lambda: b'{"fx": 100.0, "fy": 120, "cx": 8, "cy": 6.5, "crop": [0, 0], "repair": {}}',
    ),
    "color": ("rgb_000_00.png", lambda: _image("color")),
    "depth": ("depth_000_00.png", lambda: _image("depth")),
    "label": ("label_000_00.png", lambda: _image("label")),
    "depth tif": ("depth_000_00.png", lambda: _image("depth", "TIFF")),
    "color jpg": ("rgb_000_00.png", lambda: _image("color", "JPEG")),
}


if find_spec("pye57"):  # which has no wheel for every machine
    SOUND["e57"] = ("s.e57", _e57)


@cache
def _sound(kind: str) -> bytes:
    return SOUND[kind][1]()


NUMBERS = [
    b"-1", b"0", b"1", b"255", b"2147483647", b"4294967295", b"99999999999999999999", b"1e400",
    b"nan", b"-inf", b"0x10", b"1_0", b"", b"9" * 5000, b"1,5", "١٢".encode(), "²".encode(),
]  # fmt: skip
WORDS = [
    b"x", b"y", b"label", b"vertex", b"property", b"list", b"element", b"ascii", b"binary", b"DATA",
    b"POINTS", b"double", b"int", b"end_header", b"[images]", b"\x1b[2J", b"\xff\xfe", b"\xc3\x28",
    b"a" * 9000, b"'\"'", b"#", b";", b"*", b"../*.png", b"/etc/*", b"true", b"{", b"[" * 3000,
]  # fmt: skip


def _replaced(pattern: bytes, choices: list[bytes]) -> Callable[[Random, bytes], bytes]:
    """One place among the first where the pattern stands, replaced by a choice."""

    def damage(random: Random, content: bytes) -> bytes:
        places = list(re.finditer(pattern, content[:2000])) or [re.match(b"", content)]
        place = places[random.integers(len(places))]
        assert place is not None
        choice = choices[random.integers(len(choices))]
        return content[: place.start()] + choice + content[place.end() :]

    return damage


def _cut(random: Random, content: bytes) -> bytes:
    return content[: random.integers(len(content) + 1)]


def _slice(random: Random, content: bytes) -> tuple[int, int]:
    first, second = random.integers(0, len(content) + 1, 2).tolist()
    return min(first, second), min(max(first, second), min(first, second) + 64)


def _flip_bits(random: Random, content: bytes) -> bytes:
    damaged = bytearray(content or b"\0")
    near = min(len(damaged), 400) if random.random() < 0.5 else len(damaged)
    for _ in range(random.integers(1, 9)):
        damaged[random.integers(near)] ^= 1 << random.integers(8)
    return bytes(damaged)


def _overwrite(random: Random, content: bytes) -> bytes:
    damaged = bytearray(content or b"\0")
    near = min(len(damaged), 400) if random.random() < 0.7 else len(damaged)
    at, value = random.integers(near), random.choice([0, 255, 127, 128, 10, 32])
    for place in range(at, min(at + int(random.choice([1, 2, 4, 8])), len(damaged))):
        damaged[place] = value
    return bytes(damaged)


def _leave_out(random: Random, content: bytes) -> bytes:
    first, last = _slice(random, content)
    return content[:first] + content[last:]


def _repeat(random: Random, content: bytes) -> bytes:
    first, last = _slice(random, content)
    return content[:last] + content[first:last] * int(random.integers(1, 40)) + content[last:]


def _insert(random: Random, content: bytes) -> bytes:
    at = random.integers(len(content) + 1)
    junk = [b"\0" * 8, b"\n", b"\r", b" ", random.bytes(20), b"a\n", b"\x1a", b"\xe2\x80\xa8"]
    return content[:at] + junk[random.integers(len(junk))] + content[at:]


def _long_line(random: Random, content: bytes) -> bytes:
    at = random.integers(len(content) + 1)
    unit = [b"1 ", b"1,", b"a", b"1", b" ", b"#"][random.integers(6)]
    return content[:at] + unit * (1_000_000 // len(unit)) + content[at:]


DAMAGES: dict[str, Callable[[Random, bytes], bytes]] = {
    "cut": _cut,
    "flip bits": _flip_bits,
    "overwrite": _overwrite,
    "number": _replaced(rb"\d+", NUMBERS),
    "word": _replaced(rb"[A-Za-z_]+", WORDS),
    "leave out": _leave_out,
    "repeat": _repeat,
    "insert": _insert,
    "append": lambda random, content: content + random.bytes(int(random.integers(1, 5000))),
    "garbage": lambda random, content: random.bytes(int(random.integers(0, 5000))),
    "empty": lambda random, content: b"",
    "utf-16": lambda random, content: content.decode("latin-1").encode("utf-16"),
    "utf-8 mark": lambda random, content: b"\xef\xbb\xbf" + content,
    "windows": lambda random, content: content.replace(b"\n", b"\r\n"),
    "old mac": lambda random, content: content.replace(b"\n", b"\r"),
    "long line": _long_line,
}


@dataclass(frozen=True)
class File:
    """A sound file of a kind of `SOUND` after damages of `DAMAGES`, each with a seed."""

    kind: str
    damages: tuple[tuple[str, int], ...]

    def content(self) -> bytes:
        content = _sound(self.kind)
        for name, seed in self.damages:
            content = DAMAGES[name](np.random.default_rng(seed), content)
        return content


def check_file(file: File, folder: Path) -> str:
    """Read the file as its kind is read; returns "read", or the sentence that refuses it.

    Raises AssertionError where more memory was taken than is decent or the sentence is none, and
    whatever a reader should not raise; warnings are errors.
    """
    from gclip.errors import UserError

    content = file.content()
    path = folder / SOUND[file.kind][0]
    read = _reading(file.kind, path)
    path.write_bytes(content)
    load_libraries()  # they are no part of what reading takes
    tracemalloc.start()
    before = _resident_peak(reset=True)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            read()
        outcome = "read"
    except UserError as error:
        outcome = str(error)
        _check_sentence(outcome, path)
    finally:
        traced = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    taken = max(traced, _resident_peak() - before)
    allowed = ROOM + TIMES * len(content)
    assert taken < allowed, f"{taken:,} bytes taken for a file of {len(content):,}"
    return outcome


@cache
def load_libraries() -> None:
    for name in ("laspy", "open3d", "plyfile", "pye57"):
        if find_spec(name):
            import_module(name)


def _reading(kind: str, path: Path) -> Callable[[], None]:
    """What reads a file of this kind, with what belongs to it already in its folder."""
    if kind in ("times", "days"):
        from baker.scans.times import FoundScans, schedule_scans

        scans = tuple(path.parent / name for name in ("a.xyz", "b.xyz"))
        return lambda: schedule_scans(FoundScans(scans, False), path) and None
    if kind.split()[0] in ("camera", "color", "depth", "label"):
        return _reading_images(path)
    return lambda: _read_scan(path)


def _read_scan(path: Path) -> None:
    from baker.scans.fields import choose_fields
    from baker.scans.formats import read_columns

    cloud = choose_fields(read_columns(path), path)
    assert cloud.points.shape == (len(cloud), 3)
    assert cloud.labels is None or cloud.labels.shape == (len(cloud),)
    assert cloud.colors is None or cloud.colors.shape == (len(cloud), 3)


def _reading_images(path: Path) -> Callable[[], None]:
    from baker.scans.rgbd.series import ImageSeries

    for name in ("000_00", "001_00"):
        for what, prefix in (("color", "rgb"), ("depth", "depth"), ("label", "label")):
            (path.parent / f"{prefix}_{name}.png").write_bytes(_image(what))
    camera = path if path.name.startswith("camera") else path.parent / "camera.toml"
    camera.write_bytes(CAMERA)

    def read() -> None:
        series = ImageSeries(camera)
        for entry in series.schedule.entries:
            assert np.isfinite(series.read(entry.path).points).all()

    return read


def _check_sentence(sentence: str, path: Path) -> None:
    from gclip.terminal.text import printable

    assert sentence == printable(sentence), f"more than a line, or not for a terminal: {sentence!r}"
    assert len(sentence) < 600, f"a long sentence: {sentence!r}"
    # A faulty camera or colour image may only show in what it doesn't fit.
    assert str(path.parent) in sentence, f"doesn't name the file: {sentence!r}"


def _resident_peak(reset: bool = False) -> int:
    """Most bytes of memory this process has had in use, 0 where that can't be told.

    reset: since now.
    """
    try:
        if reset:
            Path("/proc/self/clear_refs").write_text("5")
        status = Path("/proc/self/status").read_text()
    except OSError:
        return 0
    found = re.search(r"VmHWM:\s+(\d+) kB", status)
    return 1024 * int(found[1]) if found else 0


@st.composite
def all_files(draw: st.DrawFn, begins: str = "") -> File:
    """Of the kinds whose names begin so."""
    kind = draw(st.sampled_from([kind for kind in SOUND if kind.startswith(begins)]))
    usual = [name for name in DAMAGES if name not in ("garbage", "empty", "long line")]
    names = draw(st.lists(st.sampled_from(usual * 4 + list(DAMAGES)), min_size=1, max_size=4))
    return File(kind, tuple((name, draw(st.integers(0, 2**32))) for name in names))
