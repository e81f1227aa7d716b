"""Documents that contradict themselves are refused; what one leaves out has its default."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

import gclip
from gclip.file import Container, decode_document
from tests.gclip.hostile import NUMBERS, good_clips


def read(document: dict) -> gclip.Clip:
    return decode_document(Container(json.dumps(document), {}, 1 << 20), gclip.Clip)


def changed(place: tuple, field: str, value: object) -> dict:
    """A good document with one other field."""
    document = json.loads(good_clips()[0][0])
    holder = document
    for step in place:
        holder = holder[step]
    holder[field] = value
    return document


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"end": 1e-10, "start": 0.0}, r"at intervals\[0\]: it must end later"),
        ({"end": 0.0, "start": 0.0}, "it must end"),
        ({"groups": [{"first": 0, "count": 0, "motion": "move"}]}, "holds no movers"),
        ({"groups": []}, "holds no movers"),
        ({"groups": [{"first": 1, "count": 5, "motion": "move"}]}, "do not cover"),
        ({"groups": {}}, r"at intervals\[0\].groups: expected `array`, got `object`"),
        ({"groups": [7]}, r"at intervals\[0\].groups\[0\]: expected `object`, got `int`"),
        ({"groups": [{"first": 0, "count": 5}]}, "missing required field `motion`"),
        ({"box": {"low": [0, 0, 0]}}, r"at intervals\[0\].box: .* missing required field `high`"),
        ({"segments": [{"track": 0}]}, r"at intervals\[0\].segments\[0\]: .* missing .* `event`"),
        ({"degree": 0}, r"at intervals\[0\].degree: expected `int` >= 1"),
    ],
)
def test_intervals_that_are_none_are_named(change: dict, words: str) -> None:
    document = json.loads(good_clips()[0][0])
    document["intervals"][0] |= change
    with pytest.raises(gclip.ClipError, match=words):
        read(document)


@pytest.mark.parametrize(
    ("place", "field", "value", "words"),
    [
        ((), "intervals", [], "at intervals: .* length >= 1"),
        ((), "scans", [], r"at scans: expected `array` of length >= 2"),
        ((), "tracks", [], r"at tracks: expected `array` of length >= 1"),
        ((), "up", "w", r"at up: expected `str` matching regex '\^-\?\[xyz\]\$'"),
        ((), "spacing", -1.0, "at spacing: expected `float` >= 0"),
        ((), "origin", [0, 1], "at origin: expected `array` of length 3, got 2"),
        ((), "sha256", {"document": "0"}, "at sha256"),
        (("intervals", 0), "start", 0.5, "do not span"),
        (("intervals", 2), "end", 7.0, "do not span"),
        (("intervals", 1), "start", 2.5, "without a gap"),
        (("scans", 1), "time", 2.5, "do not span the series from scan to scan"),
        (("scans", 1), "time", 0.0, "scans' times do not ascend"),
        (("scans", 1), "time", 5.0, "scans' times do not ascend"),
        (("scans", 1), "name", "a" * 1001, "expected `str` of length <= 1000"),
        (("tracks", 0), "color", [0, 0, 255.5], "expected `int`, got `float`"),
        (("tracks", 0), "color", [0, -1, 0], "expected `int` >= 0"),
        (("tracks", 0), "color", [256, 0, 0], r"at tracks\[0\].color\[0\]: expected `int` <= 255"),
        (("intervals", 0, "box"), "low", [0, 1e9, 0], "low corner lies above"),
        (("intervals", 0, "groups", 0), "count", 2**48, "expected `int` <= 281474976710655"),
    ],
)
def test_documents_that_contradict_themselves(
    place: tuple, field: str, value: object, words: str
) -> None:
    assert read(json.loads(good_clips()[0][0]))
    with pytest.raises(gclip.ClipError, match=words):
        read(changed(place, field, value))


def test_segments_are_of_tracks_that_are_named() -> None:
    segment: dict[str, Any] = {"event": "birth", "start_points": 1, "end_points": 2, "movers": 3}
    assert read(changed(("intervals", 0), "segments", [{"track": 1, **segment}]))
    with pytest.raises(gclip.ClipError, match="track is 2; only 2 tracks are named"):
        read(changed(("intervals", 0), "segments", [{"track": 2, **segment}]))


@pytest.mark.parametrize("value", [v for v in NUMBERS if v == v and abs(v) != float("inf")])
def test_numbers_are_within_bounds_or_refused(value: float) -> None:
    for field, fine in (
        ("floor", -1e18 <= value <= 1e18 and value is not True),
        ("spacing", 0 <= value <= 1e18 and value is not True),
    ):
        if fine:
            assert getattr(read(changed((), field, value)), field) == float(value)
        else:
            with pytest.raises(gclip.ClipError, match=rf"at {field}: |digits; use"):
                read(changed((), field, value))
    count = isinstance(value, int) and value is not True and 0 <= value < 2**48
    if count:
        assert read(changed(("scans", 0), "points", value)).scans[0].points == value
    else:
        with pytest.raises(gclip.ClipError, match=r"at scans\[0\].points: |digits; use"):
            read(changed(("scans", 0), "points", value))


@pytest.mark.parametrize("wrong", [True, None, "1", [], {}, [1]])
def test_what_is_no_number_is_refused(wrong: object) -> None:
    with pytest.raises(gclip.ClipError, match="at floor: expected `float`, got"):
        read(changed((), "floor", wrong))


@pytest.mark.parametrize(
    ("index", "parent", "fine"),
    [(1, 0, True), (1, None, True), (0, 1, True), (1, 1, False), (1, 2, False), (1, -1, False)],
)
def test_parents_are_other_tracks(index: int, parent: int | None, fine: bool) -> None:
    document = changed(("tracks", index), "parent", parent)
    if fine:
        assert read(document).track_table[index].parent == parent
    else:
        with pytest.raises(gclip.ClipError, match=r"tracks\[1\].parent"):
            read(document)


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
    found = read(document)
    assert (found.up, found.unit, found.time_unit) == ("-x", "", "days")
    assert (found.origin, found.floor, found.spacing) == ((0.0, 0.0, 0.0), 0.0, 0.0)
    assert (found.provenance, found.held_out, found.fields) == ({}, (), ())
    assert found.scans[1] == gclip.ScanMark("b", 4.5, "", 5)
    (track,) = found.track_table
    assert (track.name, track.color, track.parent) == ("stem", (1, 2, 3), None)
    assert (track.born, track.lost, track.kind) == (0.0, None, "organ")
    (interval,) = found.intervals
    assert (interval.start, interval.end, interval.degree, interval.box) == (3.0, 4.5, 2, None)
    assert interval.groups == (gclip.Group(0, 7, gclip.Motion.FADE),)
    segment = {"track": 0, "event": "birth", "start_points": 1, "end_points": 2, "movers": 3}
    document["intervals"][0]["segments"] = [segment]  # type: ignore[index]
    (interval,) = read(document).intervals
    assert interval.segments == (gclip.SegmentPair(0, "birth", 1, 2, 3, "", 0.0, 0.0, ()),)


@pytest.mark.parametrize(
    ("version", "words"),
    [
        ("2", "newer version"),
        ("1000000.0", "newer version"),
        ("9" * 900, "newer version"),
        ("", "at version: expected `str` matching"),
        ("-1.0", "at version"),
        ("²", "at version"),
        ("1.99", ""),
        ("0.9", ""),
    ],
)
def test_versions(version: str, words: str) -> None:
    if words:
        with pytest.raises(gclip.ClipError, match=words):
            read(changed((), "version", version))
    else:
        assert read(changed((), "version", version) | {"unknown": 7})


def test_a_newer_version_is_told_whatever_else_it_says() -> None:
    with pytest.raises(gclip.ClipError, match="newer version"):
        read({"version": "2.0", "scans": 7})


def test_documents_are_of_bounded_depth() -> None:
    def nested(levels: int) -> dict:
        value: object = 1
        for _ in range(levels):
            value = [value]
        return changed((), "provenance", {"deep": value})

    assert read(nested(30)).provenance
    with pytest.raises(gclip.ClipError, match="its document is nested more than 32 levels deep"):
        read(nested(31))


def test_a_clip_that_contradicts_itself_cannot_be_made(make_clip: Any) -> None:
    clip = make_clip()
    for wrong, words in (
        ({"scans": clip.scans[:2]}, "do not span the series"),
        ({"scans": clip.scans[::-1]}, "do not ascend"),
        ({"intervals": clip.intervals[::-1]}, "without a gap"),
        ({"track_table": (replace(clip.track_table[0], parent=7),)}, "no other track's id"),
    ):
        with pytest.raises(ValueError, match=words):
            replace(clip, **wrong)
