"""Damaged files are read or refused in one sentence (tests/baker/hostile_files.py)."""

import re
import struct
import subprocess
import sys
import tracemalloc
import zlib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

from baker.errors import InputError
from baker.scans.child_process import ChildProcess
from baker.scans.formats import read_columns
from baker.scans.rgbd.camera import read_camera
from baker.scans.rgbd.images import read_pixels
from baker.scans.times.schedule import schedule_scans
from tests.baker.hostile_files import File, all_files, check_file
from tests.baker.sound_files import CAMERA, SOUND

HUGE = 10**15


@pytest.mark.parametrize("kind", SOUND)
def test_sound_files_are_read(kind, tmp_path):
    assert check_file(File(kind, ()), tmp_path) == "read"


@pytest.mark.parametrize(
    "file",
    [
        File("settings", (("word", 2663),)),
        File("corrections", (("long line", 380333), ("long line", 228), ("long line", 228))),
        File("xyz", (("repeat", 2599), ("number", 2599), ("repeat", 2599), ("repeat", 2599))),
    ],
    ids=str,
)
def test_what_the_fuzzer_found_is_read_or_refused_by_name(file, tmp_path):
    check_file(file, tmp_path)


@given(all_files())
@settings(max_examples=250, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
def test_any_damage_is_read_or_refused_by_name(tmp_path_factory, file):
    check_file(file, tmp_path_factory.mktemp("files"))


def test_the_fuzzer_finds_nothing_in_a_few_files():
    command = [sys.executable, "-m", "tests.baker.fuzz_scans", "--only", "files"]
    command += ["--kind", "xyz", "--count", "5", "--seed", "1"]
    done = subprocess.run(command, cwd=Path(__file__).parents[2], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "files: 5 cases" in done.stdout


def refused(path: Path, content: bytes) -> str:
    """The sentence that refuses a file, which costs no memory. (Quadratic time would never end.)"""
    path.write_bytes(content)
    tracemalloc.start()
    try:
        with pytest.raises(InputError) as error:
            read_columns(path)
        assert tracemalloc.get_traced_memory()[1] < (48 << 20) + 40 * len(content)
    finally:
        tracemalloc.stop()
    return str(error.value)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        (
            "a.ply",
            f"ply\nformat binary_little_endian 1.0\nelement vertex {HUGE}\n"
            "property float x\nproperty float y\nproperty float z\nend_header\n",
        ),
        (
            "b.ply",
            f"ply\nformat ascii 1.0\nelement face {HUGE}\nelement vertex 3\nproperty float x\n"
            "property float y\nproperty float z\nend_header\n0 0 0\n",
        ),
        ("c.ply", f"ply\nformat ascii 1.0\nelement vertex {'9' * 5000}\nend_header\n"),
        ("d.pcd", f"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS {HUGE}\nDATA ascii\n0 0 0\n"),
        ("e.pcd", f"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS {HUGE}\nDATA binary\n000000"),
        (
            "f.pcd",
            f"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS {HUGE}\nDATA binary_compressed\n"
            "\x00\x01\x00\x00\x00\x01\x00\x00",
        ),
        ("g.pts", f"{HUGE}\n0 0 0\n1 1 1\n"),
    ],
)
def test_counts_that_lie_make_no_room(name, content, tmp_path):
    assert re.search(r"announces|not a valid PLY", refused(tmp_path / name, content.encode()))


def test_fields_of_many_values_make_no_room(tmp_path):
    many = 500
    header = (
        f"FIELDS {' '.join(f'f{i}' for i in range(many))}\nSIZE{' 4' * many}\nTYPE{' F' * many}\n"
        f"COUNT{' 4095' * many}\nPOINTS 1\nDATA binary\n"
    )
    assert "announces 1 points" in refused(tmp_path / "a.pcd", header.encode())


@pytest.mark.parametrize("unit", [b"1 ", b"1,", b"x,", b"a", b" ", b"#", b"\t"])
def test_a_line_of_ten_megabytes_is_refused_at_once(unit, tmp_path):
    line = unit * (10_000_000 // len(unit))
    assert "line 1" in refused(tmp_path / "a.txt", line + b"\n0 0 0\n")
    if unit not in (b"#", b" ", b"\t"):  # a comment or nothing, however long
        assert "line 3" in refused(tmp_path / "a.csv", b"x,y,z\n0,0,0\n" + line + b"\n")


def test_a_header_of_many_columns_is_refused_at_once(tmp_path):
    names = ",".join(f"x{i % 60000}" for i in range(20_000)) + ",x,y,z,x\n"
    assert "two columns" in refused(
        tmp_path / "a.csv", (names + ",".join(["0"] * 20_004) + "\n").encode()
    )


def test_a_times_file_of_blanks_is_read_at_once(tmp_path):
    path = tmp_path / "times.csv"
    path.write_text("a.xyz," + " " * 3_000_000 + "x\n")
    with pytest.raises(InputError, match=r"times\.csv' has no line for the scan 'a.xyz'"):
        schedule_scans((tmp_path / "a.xyz", tmp_path / "b.xyz"), path)


def test_sizes_that_lie_end_no_bake(tmp_path):
    """Decoders would ask for as many bytes, and abort without them."""
    laz, layered, glb = (SOUND[kind][1]() for kind in ("laz 1.2", "laz 1.4", "glb"))
    chunk_size = laz.index(struct.pack("<I", 50_000))
    points = struct.unpack_from("<I", layered, 96)[0]
    table = struct.unpack_from("<q", layered, points)[0]
    layers = points + 8 + 40 + 4
    places = (layered, table + 4), (layered, layers), (layered, layers + 8), (laz, chunk_size)
    with ChildProcess() as child:
        for sound, place in (*places, (glb, 12)):
            lying = sound[:place] + struct.pack("<I", 3_400_000_000) + sound[place + 4 :]
            path = tmp_path / ("a.glb" if sound is glb else "a.laz")
            path.write_bytes(lying)
            with pytest.raises(InputError, match=r"or is cut short"):
                read_columns(path, (), child)


@pytest.mark.parametrize("side", [9_999, 13_000, 14_000, 60_000])
def test_a_picture_of_too_many_pixels_is_not_unpacked(side, tmp_path):
    path = tmp_path / "rgb_a.png"
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)), (b"IDAT", b""))
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + b"".join(
            struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
            for name, body in chunks
        )
    )
    said = "bytes can't hold so many" if side < 13_500 else "exceeds limit of"
    with pytest.raises(InputError, match=said):
        read_pixels(path, "RGB", "RGB")


def test_a_part_of_a_picture_that_lies_makes_no_room(tmp_path):
    lying = ("overwrite", 19), ("overwrite", 183899083), ("repeat", 183899083)
    for damages in (lying, (*lying, lying[-1])):
        assert "image" in check_file(File("depth", damages), tmp_path)


def test_pictures_that_need_other_programs_are_not_opened(tmp_path):
    path = tmp_path / "rgb_a.png"
    path.write_bytes(
        b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 10 10\n%%EndComments\nshowpage\n"
    )
    with pytest.raises(InputError, match="can't be read as an image"):
        read_pixels(path, "RGB", "RGB")


def test_what_a_file_says_cannot_command_the_terminal(tmp_path):
    for name, text in (
        ("a.ply", "ply\n\x1b[2J\x1b]0;title\x07 x\nend_header\n"),
        ("b.txt", "\x1b[31m 0 0\n"),
        ("c.csv", "x,y,z,\x1b[2J,\x1b[2J\n0,0,0,0,0\n"),
        ("d.pcd", "FIELDS \x1b[2J\nSIZE 3\nTYPE \x9b\nPOINTS 1\nDATA ascii\n"),
    ):
        assert refused(tmp_path / name, text.encode()).isprintable()


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("camera.toml", lambda text: text + "deep = " + "[" * 50_000),
        ("camera.json", lambda text: "[" * 50_000),
        ("camera.toml", lambda text: text + "#" * 100_000),
        ("camera.json", lambda text: '{"fx": NaN, "fy": 1, "cx": 1, "cy": 1}'),
        ("camera.json", lambda text: '{"fx": 1e-320, "fy": 1, "cx": 1, "cy": 1}'),
        ("camera.toml", lambda text: text.replace("100.0", "9" * 400)),
        ("camera.toml", lambda text: text.replace("100.0", "9" * 6000)),
        ("camera.toml", lambda text: text.replace("depth_unit = 1", "depth_unit = 1e999")),
        ("camera.toml", lambda text: text.replace("[0, 0]", "[true, 0]")),
        ("camera.toml", lambda text: text.replace("[0, 0]", f"[{10**30}, 0]")),
        ("camera.toml", lambda text: text.replace("per_day = 6", f"per_day = {10**12}")),
        ("camera.toml", lambda text: text.replace("background = 0", f"background = {2**70}")),
        ("camera.toml", lambda text: text.replace("cx = 8", "cx = -1e300")),
    ],
)
def test_no_camera_sees_so(name, change, tmp_path):
    path = tmp_path / name
    path.write_text(change(CAMERA.decode()))
    with pytest.raises(InputError, match=re.escape(f"'{path}'")):
        read_camera(path)
