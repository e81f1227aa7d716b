"""Documents that contradict themselves are refused; what one leaves out has its default."""

from __future__ import annotations

import json

import pytest

import gclip
from gclip.document import from_json
from tests.gclip.hostile import good_clips


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
