"""Clips are untrusted files: opened or refused in one sentence, whatever is in them.

`python -m bench.fuzz_clips` does the same at length; here are a few seconds of it, and one test for
each kind of bomb.
"""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import gclip
from gclip.check import check
from gclip.document import from_json
from gclip.fields import SPARE, Fields, footprint, parse
from gclip.text import printable
from tests.gclip.hostile import BOMBS, INJECTIONS, NUMBERS, good_clips, hostile

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
            assert not check(path).whole
            return
        clip = gclip.open(path)
        for day in (clip.times[0], clip.times[-1], sum(clip.times[:2]) / 2):
            frame = clip.at(day)
            assert np.isfinite(frame.positions).all()
            assert len(frame.colors) == len(frame.tracks) == len(frame)


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


def test_a_document_is_measured_before_it_is_read() -> None:
    text = '{"a":[' + "[]," * 450_000 + "0]}"
    with pytest.raises(gclip.ClipError, match="far more values"):
        parse(text, 1000)
    assert parse(text, footprint(text)).items("a")[0] == []
    edge = (footprint(text) - SPARE + 1) // 2
    with pytest.raises(gclip.ClipError, match="far more values"):
        parse(text, edge - 1)
    parse(text, edge)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"a":1,"a":1}', "the same field twice"),
        ('{"a":NaN}', "holds NaN"),
        ('{"a":-Infinity}', "holds -Infinity"),
        ('{"a":1e999}', "more than a number can be"),
        ('{"a":-1e999}', "more than a number can be"),
        ('{"a":' + "9" * 5000 + "}", "too many digits"),
        ("[" * 100_000, "nested too deeply"),
        ('{"a":' * 100_000, "nested too deeply"),
        ("[1,", "at character 3"),
        ("", "at character 0"),
        ("7", "its document is not an object"),
        ("null", "its document is not an object"),
    ],
)
def test_what_is_no_document_is_named(text: str, words: str) -> None:
    with pytest.raises(gclip.ClipError, match=words):
        parse(text, 1 << 20)


@pytest.mark.parametrize("value", [v for v in NUMBERS if not isinstance(v, bool)])
def test_numbers_are_within_bounds_or_refused(value: float) -> None:
    fields = Fields({"x": value, "v": [value, 0, 0]})
    if -1e18 <= value <= 1e18:
        assert fields.number("x") == float(value)
        assert fields.vector("v") == (float(value), 0, 0)
    else:
        for read in (fields.number, fields.optional_number):
            with pytest.raises(gclip.ClipError, match=r"x is .*; a number up to 1e\+18 is needed"):
                read("x")
        with pytest.raises(gclip.ClipError, match="v is a list; three times a number"):
            fields.vector("v")
    if isinstance(value, int) and 0 <= value < 2**48:
        assert fields.count("x") == fields.optional_count("x") == value
    else:
        with pytest.raises(gclip.ClipError, match="a whole number from 0 is needed"):
            fields.count("x")


@pytest.mark.parametrize("wrong", [True, None, "1", [], {}, [1]])
def test_what_is_no_number_is_refused(wrong: object) -> None:
    for read in (Fields({"x": wrong}).number, Fields({"x": wrong}).count):
        with pytest.raises(gclip.ClipError, match="x is"):
            read("x")


def test_a_number_below_the_least_is_refused() -> None:
    assert Fields({"x": 2}).number("x", lowest=2.0) == 2.0
    with pytest.raises(gclip.ClipError, match=r"x is 1\.9; at least 2 is needed"):
        Fields({"x": 1.9}).number("x", lowest=2.0)


@pytest.mark.parametrize("length", [2, 4])
def test_vectors_have_three_numbers(length: int) -> None:
    with pytest.raises(gclip.ClipError, match="three"):
        Fields({"v": [0.0] * length}).vector("v")


def test_text_is_of_bounded_length_and_gives_no_orders() -> None:
    assert Fields({"x": "a" * 1000}).text("x") == "a" * 1000
    with pytest.raises(gclip.ClipError, match="1001 characters long; 1000 are allowed"):
        Fields({"x": "a" * 1001}).text("x")
    for text in INJECTIONS:
        read = Fields({"x": text[:1000], "l": [text, "b"], "o": {text: [text]}})
        assert read.text("x") == printable(text[:1000])
        assert read.texts("l")[0] == printable(text, 1000)
        assert read.anything("o") == {printable(text): [printable(text)]}
    with pytest.raises(gclip.ClipError, match="l holds something else than text"):
        Fields({"l": ["a", 1]}).texts("l")


def test_printable_shows_what_people_write_and_nothing_else() -> None:
    joined = "می\N{ZERO WIDTH NON-JOINER}روم"
    spaced = ("葉\N{IDEOGRAPHIC SPACE}1", "a\N{NO-BREAK SPACE}b")
    for plain in ("", "leaf 3", "Blatt №5 – größer", "🌱", joined, *spaced):
        assert printable(plain) == plain
    assert printable("a\x1b[2Jb\nc\u202ed\ud800e\u2028") == "a\ufffd[2Jb\ufffdc\ufffdd\ufffde\ufffd"
    assert printable("abcdef", 4) == "abc…"
    assert printable("abcd", 4) == "abcd"


def test_provenance_is_of_bounded_depth() -> None:
    def nested(levels: int) -> dict:
        value: object = 1
        for _ in range(levels):
            value = [value]
        return {"p": {"deep": value}}

    assert Fields(nested(31)).anything("p")
    with pytest.raises(gclip.ClipError, match="p is nested more than 32 levels deep"):
        Fields(nested(32)).anything("p")
    assert Fields({}).anything("p") == {}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"end": 1e-10, "start": 0.0}, "at least 1e-09 is needed"),
        ({"end": 0.0, "start": 0.0}, "it must end later"),
        ({"groups": [{"first": 0, "count": 0, "motion": "move"}]}, "holds no movers"),
        ({"groups": []}, "do not cover"),
        ({"groups": [{"first": 1, "count": 5, "motion": "move"}]}, "do not cover"),
        ({"groups": {}}, r"intervals\[0\].groups is an object; a list is needed"),
        ({"groups": [7]}, r"intervals\[0\].groups\[0\] is not an object"),
        ({"box": {"low": [0, 0, 0]}}, r"intervals\[0\].box.high is missing"),
        ({"segments": [{"track": 2}]}, "segments.*only 2 tracks are named"),
        ({"degree": 0}, "degree is 0"),
    ],
)
def test_intervals_that_are_none_are_named(change: dict, words: str) -> None:
    document = json.loads(good_clips()[0][0])
    document["intervals"][0] |= change
    with pytest.raises(gclip.ClipError, match=words):
        from_json(json.dumps(document), 1 << 20)


@pytest.mark.parametrize(
    ("place", "field", "value", "words"),
    [
        ((), "intervals", [], "do not span"),
        (("intervals", 0), "start", 0.5, "do not span"),
        (("intervals", 2), "end", 7.0, "do not span"),
        (("intervals", 1), "start", 2.5, "without a gap"),
        (("scans", 1), "time", 2.5, "inside an interval"),
        (("scans", 1), "time", 0.0, "do not ascend"),
        (("scans", 1), "time", 5.0, "do not ascend"),
        (("tracks", 0), "color", [0, 0, 255.5], "whole numbers from 0 to 255"),
        (("tracks", 0), "color", [0, -1, 0], "whole numbers from 0 to 255"),
        (("tracks", 0), "color", [256, 0, 0], "whole numbers from 0 to 255"),
        (("intervals", 0, "box"), "low", [0, 1e9, 0], "low corner lies above"),
        (("intervals", 0, "groups", 0), "count", 2**48, "a whole number from 0"),
    ],
)
def test_documents_that_contradict_themselves(
    place: tuple, field: str, value: object, words: str
) -> None:
    document = json.loads(good_clips()[0][0])
    assert from_json(json.dumps(document), 1 << 20)
    holder = document
    for step in place:
        holder = holder[step]
    holder[field] = value
    with pytest.raises(gclip.ClipError, match=words):
        from_json(json.dumps(document), 1 << 20)


@pytest.mark.parametrize(
    ("index", "parent", "fine"),
    [(1, 0, True), (1, None, True), (0, 1, True), (1, 1, False), (1, 2, False), (1, -1, False)],
)
def test_parents_are_other_tracks(index: int, parent: int | None, fine: bool) -> None:
    document = json.loads(good_clips()[0][0])
    document["tracks"][index]["parent"] = parent
    if fine:
        clip, _, _ = from_json(json.dumps(document), 1 << 20)
        assert clip.track_table[index].parent == parent
    else:
        with pytest.raises(gclip.ClipError, match="parent is"):
            from_json(json.dumps(document), 1 << 20)


def test_what_is_left_out_has_the_default_that_the_format_names() -> None:
    document = {
        "version": "1.0",
        "up": "-x",
        "scans": [{"name": n, "time": t, "points": 5} for n, t in (("a", 3.0), ("b", 4.5))],
        "tracks": [{"name": "stem", "color": [1, 2, 3]}],
        "intervals": [
            {
                "start": 3.0,
                "end": 4.5,
                "degree": 2,
                "groups": [{"first": 0, "count": 7, "motion": "fade"}],
            }
        ],
    }
    clip, (header,), held_out = from_json(json.dumps(document), 1000)
    assert (clip.up, clip.unit, clip.time_unit) == ("-x", "", "days")
    assert (clip.origin, clip.floor, clip.spacing) == ((0.0, 0.0, 0.0), 0.0, 0.0)
    assert (clip.provenance, held_out) == ({}, [])
    assert clip.scans[1] == gclip.ScanMark("b", 4.5, "", 5)
    assert clip.track_table == (gclip.Track(0, "stem", (1, 2, 3), None, 0.0, None, "organ"),)
    assert (header.start, header.end, header.degree, header.box) == (3.0, 4.5, 2, None)
    assert header.groups == (gclip.Group(0, 7, gclip.Motion.FADE),)
    segment = {"track": 0, "event": "birth", "start_points": 1, "end_points": 2, "movers": 3}
    document["intervals"][0]["segments"] = [segment]  # type: ignore[index]
    _, (header,), _ = from_json(json.dumps(document), 1000)
    assert header.segments == (gclip.SegmentPair(0, "birth", 1, 2, 3, "", 0.0, 0.0, ()),)


@pytest.mark.parametrize(
    ("version", "words"),
    [
        ("2", "newer version"),
        ("1000000.0", "newer version"),
        ("9" * 900, "newer version"),
        ("", '"1.0" is expected'),
        ("-1.0", '"1.0" is expected'),
        ("²", '"1.0" is expected'),
        ("1.99", ""),
        ("0.9", ""),
    ],
)
def test_versions(version: str, words: str) -> None:
    document = json.loads(good_clips()[0][0])
    document["version"] = version
    if words:
        with pytest.raises(gclip.ClipError, match=words):
            from_json(json.dumps(document), 1 << 20)
    else:
        assert from_json(json.dumps(document), 1 << 20)


def test_headers_are_in_proportion_to_the_file(tmp_path: Path) -> None:
    path = tmp_path / "x.gclip"
    length = 12 << 20
    for size, words in (
        (16 << 20, "not a growth clip, or cut short or damaged"),  # in proportion, yet no JSON
        ((16 << 20) - 1, f"its header is {length} bytes long, too much"),
        (length + 8, f"its header is {length} bytes long, too much"),
        (length + 7, "cut short within its header"),
    ):
        with path.open("wb") as file:
            file.write(length.to_bytes(8, "little"))
            file.truncate(size)
        assert words in refusal(path)
    path.write_bytes(b"\0" * 7)
    assert "cut short within its header" in refusal(path)


def test_float32_positions_are_within_bounds(make_clip, tmp_path: Path) -> None:
    path = tmp_path / "x.gclip"
    for value in (1e18, -1e18):
        clip = make_clip(precision="float32")
        clip.intervals[1].end_positions[3, 2] = value
        clip.save(path)
        assert not refusal(path)
        clip.intervals[1].end_positions[3, 2] = np.nextafter(
            np.float32(value), np.float32(9 * value)
        )
        clip.save(path)
        assert '"0001/end" holds a position that is not finite, or beyond' in refusal(path)


def test_what_would_be_refused_is_not_written(make_clip, tmp_path: Path) -> None:
    from dataclasses import replace

    path = tmp_path / "x.gclip"
    make_clip().save(path)
    before = path.read_bytes()
    clip = make_clip()
    for wrong in (
        replace(clip, scans=clip.scans[:1]),
        replace(clip, spacing=1e19),
        replace(clip, up="w"),
        replace(clip, track_table=()),
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
    assert check(tmp_path / "x.gclip").whole


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
        ("a\0b", "no such file"),
        ("file/inside", "Not a directory"),
        ("n" * 300, "File name too long"),
    ):
        assert words in refusal(tmp_path / name)


def test_a_file_replaced_while_it_is_opened_is_opened_again(
    make_clip, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import gclip.container as container

    path, other = tmp_path / "x.gclip", tmp_path / "y.gclip"
    make_clip(degree=1).save(path)
    make_clip(degree=3).save(other)
    real, replaced = container._header, []

    def header(where: Path, first: int):  # type: ignore[no-untyped-def]
        found = real(where, first)
        if not replaced:
            replaced.append(os.replace(other, path))
        return found

    monkeypatch.setattr(container, "_header", header)
    assert gclip.open(path).intervals[0].degree == 3

    def always(where: Path, first: int):  # type: ignore[no-untyped-def]
        os.utime(path, ns=(0, len(replaced)))
        replaced.append(None)
        return real(where, first)

    monkeypatch.setattr(container, "_header", always)
    assert "it is being written right now" in refusal(path)
