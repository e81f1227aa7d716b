"""The clip's JSON document: everything but the buffers, read field by field with clear refusals."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from gclip.clip import UP_AXES, Box, Clip, Group, Interval, Motion, ScanMark, SegmentPair, Track
from gclip.errors import ClipError
from gclip.fields import Fields, parse
from gclip.text import printable

VERSION = (1, 1)
SHORTEST = 1e-9  # time between the ends of an interval
DOCUMENT, BLANK = "document", "0" * 64


@dataclass(frozen=True)
class IntervalHeader:
    """What the document says of an interval before its buffers are looked at."""

    start: float
    end: float
    degree: int
    box: Box | None
    groups: tuple[Group, ...]
    segments: tuple[SegmentPair, ...]


def to_json(clip: Clip, checksums: Mapping[str, str]) -> str:
    """The document of a clip, byte for byte the same for the same clip.

    checksums: of the buffers by name, as `checksum` gives them; the document's own is added.
    """
    blank = _dumped(clip, {**checksums, DOCUMENT: BLANK})
    return _dumped(clip, {**checksums, DOCUMENT: checksum(blank.encode())})


def checksum(content: Any) -> str:
    """SHA-256 of bytes, or of an array in C order, in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def document_checksum(text: str, written: str) -> str:
    """What the checksum of a document is that says it is `written`: taken with zeros in its place,
    because no text can hold a checksum of itself.
    """
    return checksum(text.replace(written, BLANK).encode())


def _dumped(clip: Clip, checksums: Mapping[str, str]) -> str:
    text = json.dumps(
        {
            "version": f"{VERSION[0]}.{VERSION[1]}",
            "up": clip.up,
            "unit": clip.unit,
            "time_unit": clip.time_unit,
            "origin": list(clip.origin),
            "floor": clip.floor,
            "spacing": clip.spacing,
            "scans": [
                {"name": s.name, "time": s.time, "date": s.date, "points": s.points}
                for s in clip.scans
            ],
            "tracks": [
                {
                    "name": t.name,
                    "color": list(t.color),
                    "parent": t.parent,
                    "born": t.born,
                    "lost": t.lost,
                    "kind": t.kind,
                }
                for t in clip.track_table
            ],
            "intervals": [_interval_to_json(interval) for interval in clip.intervals],
            **_held_out_to_json(clip),
            "provenance": clip.provenance,
            "sha256": dict(checksums),
        },
        sort_keys=True,
        separators=(",", ":"),
        ensure_ascii=False,
        allow_nan=False,
    )
    return printable(text)  # names of files need not be UTF-8


def _held_out_to_json(clip: Clip) -> dict[str, Any]:
    """Nothing where there is nothing: most clips were baked from all scans."""
    marks = [
        {"name": s.name, "time": s.time, "date": s.date, "points": len(s.positions)}
        for s in clip.held_out
    ]
    return {"held_out": marks} if marks else {}


def _interval_to_json(interval: Interval) -> dict[str, Any]:
    box = interval.box
    return {
        "start": interval.start,
        "end": interval.end,
        "degree": interval.degree,
        "box": None if box is None else {"low": list(box.low), "high": list(box.high)},
        "groups": [
            {"first": g.first, "count": g.count, "motion": str(g.motion)} for g in interval.groups
        ],
        "segments": [
            {
                "track": s.track,
                "event": s.event,
                "start_points": s.start_points,
                "end_points": s.end_points,
                "movers": s.movers,
                "solver": s.solver,
                "cost": s.cost,
                "marginal_error": s.marginal_error,
                "notes": list(s.notes),
            }
            for s in interval.segments
        ],
    }


def from_json(text: str, file_size: int) -> tuple[Clip, list[IntervalHeader], list[ScanMark]]:
    """A clip without buffers, and the intervals and the scans left out that it announces.

    file_size: bytes of the file, which bound what is read.
    Raises ClipError naming the field, what was found and what is allowed.
    """
    root = parse(text, file_size)
    _check_version(root.text("version"))
    scans = tuple(_scan(f) for f in root.objects("scans"))
    if len(scans) < 2:
        raise ClipError(f"scans holds {len(scans)} entries; at least 2 are needed")
    if any(a.time >= b.time for a, b in pairwise(scans)):
        raise ClipError("the scans' times do not ascend")
    fields = root.objects("tracks")
    tracks = tuple(_track(f, i, len(fields)) for i, f in enumerate(fields))
    if not tracks:
        raise ClipError("tracks is empty; at least one is needed")
    headers = [_interval_header(f, len(tracks)) for f in root.objects("intervals")]
    _check_times(scans, headers)
    held_out = [_scan(f) for f in root.objects("held_out", optional=True)]
    _check_held_out(scans, held_out)
    clip = Clip(
        scans=scans,
        intervals=(),
        track_table=tracks,
        origin=root.vector("origin", (0.0, 0.0, 0.0)),
        up=root.one_of("up", UP_AXES),
        unit=root.text("unit", ""),
        time_unit=root.one_of("time_unit", ("days", "scans"), "days"),
        floor=root.number("floor", 0.0),
        spacing=root.number("spacing", 0.0, lowest=0.0),
        provenance=root.anything("provenance"),
    )
    return clip, headers, held_out


def _check_version(version: str) -> None:
    major = version.split(".")[0]
    if not (major.isascii() and major.isdigit()):
        raise ClipError(f'its version is "{version[:20]}"; "{VERSION[0]}.0" is expected')
    if len(major) > 6 or int(major) > VERSION[0]:
        raise ClipError(
            f"it was written in clip format {version[:20]}; this program reads up to "
            f"{VERSION[0]}.x, so a newer version of it is needed"
        )


def _check_times(scans: tuple[ScanMark, ...], headers: list[IntervalHeader]) -> None:
    ends = [header.end for header in headers]
    starts = [header.start for header in headers]
    if not headers or starts[0] != scans[0].time or ends[-1] != scans[-1].time:
        raise ClipError("the intervals do not span the scans' times")
    if starts[1:] != ends[:-1]:
        raise ClipError("the intervals do not follow one another without a gap")
    if not {scan.time for scan in scans} <= {*starts, ends[-1]}:
        raise ClipError("a scan's time lies inside an interval")


def _scan(f: Fields) -> ScanMark:
    return ScanMark(f.text("name"), f.number("time"), f.text("date", ""), f.count("points"))


def _check_held_out(scans: tuple[ScanMark, ...], held_out: list[ScanMark]) -> None:
    times = [scan.time for scan in held_out]
    if any(a >= b for a, b in pairwise(times)):
        raise ClipError("the times in held_out do not ascend")
    if times and not scans[0].time <= times[0] <= times[-1] <= scans[-1].time:
        raise ClipError("a time in held_out lies outside the series")


def _track(f: Fields, index: int, total: int) -> Track:
    color = f.vector("color")
    if not all(c == int(c) and 0 <= c <= 255 for c in color):
        raise ClipError(f"{f.place}.color is {list(color)}; whole numbers from 0 to 255 are needed")
    parent = f.optional_count("parent")
    if parent is not None and (parent >= total or parent == index):
        raise ClipError(f"{f.place}.parent is {parent}; another track's id below {total} is needed")
    return Track(
        id=index,
        name=f.text("name"),
        color=(int(color[0]), int(color[1]), int(color[2])),
        parent=parent,
        born=f.number("born", 0.0),
        lost=f.optional_number("lost"),
        kind=f.text("kind", "organ"),
    )


def _interval_header(f: Fields, tracks: int) -> IntervalHeader:
    start, end = f.number("start"), f.number("end")
    if start >= end:
        raise ClipError(f"{f.place} starts at {start:g} and ends at {end:g}; it must end later")
    if end - start < SHORTEST:
        raise ClipError(f"{f.place} is {end - start:g} long; at least {SHORTEST:g} is needed")
    degree = f.count("degree")
    if degree not in (1, 2, 3):
        raise ClipError(f"{f.place}.degree is {degree}; 1, 2 or 3 is allowed")
    box = None
    if f.present("box"):
        corner = f.object("box")
        box = Box(corner.vector("low"), corner.vector("high"))
        if any(low > high for low, high in zip(box.low, box.high, strict=True)):
            raise ClipError(f"{f.place}.box: its low corner lies above its high corner")
    groups = tuple(
        Group(g.count("first"), g.count("count"), Motion(g.one_of("motion", tuple(Motion))))
        for g in f.objects("groups")
    )
    if not groups or any(a.stop != b.first for a, b in pairwise((Group(0, 0), *groups))):
        raise ClipError(f"{f.place}.groups do not cover the movers one after the other")
    if groups[-1].stop == 0:
        raise ClipError(f"{f.place} holds no movers; at least one is needed")
    segments = tuple(_segment(s, tracks) for s in f.objects("segments", optional=True))
    return IntervalHeader(start, end, degree, box, groups, segments)


def _segment(f: Fields, tracks: int) -> SegmentPair:
    track = f.count("track")
    if track >= tracks:
        raise ClipError(f"{f.place}.track is {track}; only {tracks} tracks are named")
    return SegmentPair(
        track=track,
        event=f.one_of("event", ("match", "birth", "loss")),
        start_points=f.count("start_points"),
        end_points=f.count("end_points"),
        movers=f.count("movers"),
        solver=f.text("solver", ""),
        cost=f.number("cost", 0.0),
        marginal_error=f.number("marginal_error", 0.0),
        notes=f.texts("notes"),
    )
