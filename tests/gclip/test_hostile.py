"""Clips are untrusted files: opened or refused in one sentence, whatever is in them.

`python -m tests.gclip.fuzz_clips` does the same at length; here are a few seconds of it, and one
test for each kind of bomb.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import gclip
from gclip import check
from gclip.text import printable
from tests.gclip.hostile import BOMBS, hostile

UNTIMED = settings(
    deadline=None,
    max_examples=250,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def refusal(path: Path) -> str:
    """Why a file is refused, one sentence; "" where it is a clip."""
    try:
        gclip.open(path)
    except gclip.ClipError as error:
        sentence = str(error)
        assert sentence.startswith(printable(str(path)))
        assert sentence.endswith(".")
        assert sentence.isprintable()
        assert len(sentence) < 600
        return sentence
    return ""


@UNTIMED
@given(seed=st.integers(0, 2**32))
def test_any_file_is_opened_or_refused_in_a_sentence(seed: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "x.gclip")
        path.write_bytes(hostile(Random(seed)))
        if refusal(path):
            with pytest.raises(gclip.ClipError):
                check(path)
            return
        clip = gclip.open(path)
        for day in (clip.times[0], clip.times[-1], sum(clip.times[:2]) / 2):
            frame = clip.at(day)
            assert np.isfinite(frame.positions).all()
            assert len(frame.colors) == len(frame.tracks) == len(frame)


def test_the_fuzzer_finds_nothing_in_a_few_files() -> None:
    command = [sys.executable, "-m", "tests.gclip.fuzz_clips", "--count", "5", "--workers", "1"]
    done = subprocess.run(command, cwd=Path(__file__).parents[2], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith("5 cases")


@settings(UNTIMED, max_examples=60)
@given(content=st.binary(max_size=200), claimed=st.integers(0, 2**64 - 1))
def test_any_bytes_are_refused(content: bytes, claimed: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "x.gclip")
        for file in (content, claimed.to_bytes(8, "little") + content):
            path.write_bytes(file)
            assert refusal(path)


def contained(document: str) -> bytes:
    header = json.dumps({"__metadata__": {"gclip": document}}).encode()
    return len(header).to_bytes(8, "little") + header


@pytest.mark.parametrize("bomb", range(len(BOMBS)))
def test_bombs_take_no_more_memory_than_their_size_allows(bomb: int, tmp_path: Path) -> None:
    """Peak of the resident memory, beyond what the process holds before (Linux)."""
    if not Path("/proc/self/clear_refs").exists():
        pytest.skip("only Linux tells the peak of a part of a run")

    class Largest(Random):
        def choice(self, seq):  # type: ignore[no-untyped-def]
            return seq[-1]

    path = tmp_path / "x.gclip"
    path.write_bytes(contained(BOMBS[bomb](Largest())))
    refusal(path)  # imports, pools and caches
    Path("/proc/self/clear_refs").write_text("5")
    before = memory("VmRSS")
    assert refusal(path)
    assert memory("VmHWM") - before < 2 * path.stat().st_size + 64_000_000


def memory(name: str) -> int:
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(name))


def test_float32_positions_are_within_bounds(make_clip, tmp_path: Path) -> None:
    path = tmp_path / "x.gclip"
    for value in (1e18, -1e18):
        clip = make_clip(precision="float32")
        clip.intervals[1].curve[-1][3, 2] = value
        clip.save(path)
        assert not refusal(path)
        clip.intervals[1].curve[-1][3, 2] = np.nextafter(np.float32(value), np.float32(9 * value))
        reason = 'in interval 1, its buffer "end" holds a position that is not finite, or beyond'
        with pytest.raises(gclip.ClipError, match=reason):
            clip.save(path)


def test_what_would_be_refused_is_not_written(make_clip, tmp_path: Path) -> None:
    from dataclasses import replace

    path = tmp_path / "x.gclip"
    make_clip().save(path)
    before = path.read_bytes()
    clip = make_clip()
    for wrong in (
        replace(clip, spacing=1e19),
        replace(clip, up="w"),
        replace(clip, track_table=clip.track_table[:1]),
    ):
        with pytest.raises(gclip.ClipError, match="can't be written") as said:
            wrong.save(path)
        assert str(said.value).endswith(".")
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["x.gclip"]


def test_names_that_are_not_utf_8_are_written_and_read(make_clip, tmp_path: Path) -> None:
    """Names of files come as the system has them, lone surrogates for bytes that are no UTF-8."""
    from dataclasses import replace

    clip = make_clip()
    scans = tuple(replace(scan, name="caf\udce9.ply") for scan in clip.scans)
    replace(clip, scans=scans).save(tmp_path / "x.gclip")
    assert gclip.open(tmp_path / "x.gclip").scans[0].name == "caf\ufffd.ply"
    assert check(tmp_path / "x.gclip")


def test_places_that_are_no_files(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "empty").touch()
    (tmp_path / "file").touch()
    for name, words in (
        ("pipe", "not even a file"),
        (".", "not even a file"),
        ("loop", "can't be read: Too many levels of symbolic links"),
        ("empty", "cut short"),
        ("absent", "no such file"),
        ("a\0b", "not a growth clip"),
        ("file/inside", "Not a directory"),
        ("n" * 300, "File name too long"),
    ):
        assert words in refusal(tmp_path / name)


def test_a_file_replaced_while_it_is_opened_is_refused(
    make_clip, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, other = tmp_path / "x.gclip", tmp_path / "y.gclip"
    make_clip(degree=1).save(path)
    make_clip(degree=3).save(other)
    map_file = np.memmap

    def replacing(*arguments: object) -> np.memmap:
        os.replace(other, path)
        return map_file(*arguments)  # type: ignore[call-overload]

    monkeypatch.setattr(np, "memmap", replacing)
    assert refusal(path)
    monkeypatch.undo()
    assert gclip.open(path).intervals[0].degree == 3
