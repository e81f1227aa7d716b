"""Damaged files of every kind that a bake reads, and what their readers owe them.

A case is plain data, so that hypothesis can draw it and its text can be run again:

    check_file(File("ply binary", (("cut", 3), ("flip bits", 7))), folder)

`python -m tests.baker.fuzz_scans` draws thousands of them; tests/baker/test_hostile_files.py a few.
"""

from __future__ import annotations

import os
import re
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

from tests.baker.sound_files import CAMERA, SOUND, image

ROOM, TIMES = 48 << 20, 40  # bytes that reading may take, and how many more for each of the file's

Random = np.random.Generator


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
    content = file.content()
    load_libraries()  # they are no part of what reading takes
    tracemalloc.start()
    before = _resident_peak(reset=True)
    try:
        outcome = check_content(file.kind, content, folder)
    finally:
        traced = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    taken = max(traced, _resident_peak() - before)
    allowed = ROOM + TIMES * len(content)
    assert taken < allowed, f"{taken:,} bytes taken for a file of {len(content):,}"
    return outcome


def check_content(kind: str, content: bytes, folder: Path) -> str:
    """As `check_file`, of a file with this content, whatever memory it takes."""
    from gclip.errors import UserError

    path = folder / SOUND[kind][0]
    path.parent.mkdir(exist_ok=True)
    read = _reading(kind, path)
    path.write_bytes(content)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            read()
    except UserError as error:
        _check_sentence(str(error), path)
        return str(error)
    return "read"


@cache
def load_libraries() -> None:
    for name in ("scipy.interpolate", "tomllib"):
        import_module(name)
    for name in ("laspy", "open3d", "pye57"):
        if find_spec(name):
            _child().call(1 << 30, import_module_of_child, name)


def import_module_of_child(name: str) -> None:
    import_module(name)


@cache
def _child() -> Any:
    from baker.scans.child_process import ChildProcess

    return ChildProcess()


def _reading(kind: str, path: Path) -> Callable[[], None]:
    """What reads a file of this kind, with what belongs to it already in its folder."""
    if kind in ("times", "days"):
        from baker.scans.times.schedule import schedule_scans

        scans = tuple(path.parent / name for name in ("a.xyz", "b.xyz"))
        return lambda: schedule_scans(scans, path) and None
    if kind == "corrections":
        from corrections import read_corrections

        return lambda: read_corrections(path) and None
    if kind == "view path":
        from player.view.camera_animation import load_path

        clip = _clip()
        return lambda: load_path(path, clip).at(1.0) and None
    if kind == "settings":
        from player.window.settings import load_settings

        os.environ["XDG_CONFIG_HOME"] = str(path.parents[1])
        return lambda: load_settings() and None
    if kind.split()[0] in ("camera", "color", "depth", "label"):
        return _reading_images(path)
    return lambda: _read_scan(path)


@cache
def _clip() -> Any:
    from baker.interpolation.packing import Movers, pack_interval
    from gclip import Clip, Motion, Track
    from gclip.schema import ScanMark

    movers = Movers(Motion.MOVE, (np.eye(3), np.eye(3) + 1), np.zeros(3, int))
    interval = pack_interval(0.0, 3.0, [movers], spacing=1.0)
    scans = ScanMark("a.xyz", 0.0), ScanMark("b.xyz", 3.0)
    track = Track(0, "stem", (1, 2, 3))
    return Clip(scans=scans, intervals=(interval,), track_table=(track,))


def _read_scan(path: Path) -> None:
    from baker.scans.fields import choose_fields
    from baker.scans.formats import read_columns
    from baker.scans.labels import choose_labels

    columns = read_columns(path, (), _child())
    cloud = choose_labels([choose_fields(columns, path)])[0][0]
    assert cloud.points.shape == (len(cloud), 3)
    assert cloud.labels is None or cloud.labels.shape == (len(cloud),)
    assert cloud.colors is None or cloud.colors.shape == (len(cloud), 3)


def _reading_images(path: Path) -> Callable[[], None]:
    from baker.scans.rgbd.series import ImageSeries

    for name in ("000_00", "001_00"):
        for what, prefix in (("color", "rgb"), ("depth", "depth"), ("label", "label")):
            (path.parent / f"{prefix}_{name}.png").write_bytes(image(what))
    camera = path if path.name.startswith("camera") else path.parent / "camera.toml"
    camera.write_bytes(CAMERA)

    def read() -> None:
        series = ImageSeries(camera)
        for entry in series.series.scans:
            assert np.isfinite(series.read(entry.path).points).all()

    return read


def _check_sentence(sentence: str, path: Path) -> None:
    from gclip.text import printable

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
