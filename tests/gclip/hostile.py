"""Clips as nobody should write them: damaged, lying, and out of all proportion.

`hostile(random)` draws the bytes of one; the same draws give the same bytes. It begins with a good
clip and spoils it on one or more levels: the bytes, the container's header, the document, the
buffers.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from random import Random
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track

INJECTIONS = (
    "\x1b[31mred\x1b]0;title\x07\x9b2J",
    "</script><script>hurt()</script>",
    "<img src=x onerror=hurt()>",
    "=cmd|' /C calc'!A0",
    "@SUM(1+9)",
    "[bold]x[/bold][/]",
    "a\nb\r\tc\0d",
    "\u202egnp.exe",
    "\ud800",
    'x"}]}, "y": "',
    "{{7*7}}%s%n{0}",
    "../../etc/passwd",
    "",
    "🌱" * 300,
    "x" * 2_000,
)
NUMBERS: tuple[Any, ...] = (
    *(0, -0.0, 1, -1, 2, 255, 256, 65535, 65536, 2**31, 2**32, 2**48, 2**53 + 1, 2**63, 2**64),
    *(-(2**63), 10**30, -(10**400), 10**4000, 0.5, 1e-9, 1e-30, 5e-324, 1e18, 1.1e18, 1e30, 1e308),
    *(-1e308, -1e18, float("nan"), float("inf"), float("-inf"), True),
)
VALUES: tuple[Any, ...] = (*NUMBERS, *INJECTIONS, None, False, [], {}, [[]], {"a": {}}, [1, 2, 3])
KINDS = ("U8", "I8", "U16", "I16", "F16", "U32", "I32", "F32", "U64", "F64", "BOOL", "BF16", "X9")
RAW = ("NaN", "-Infinity", "1e999", "9" * 5_000, "[" * 3_000, '{"a":' * 3_000, "\\u0000", "", "}")

Document = dict[str, Any]
Buffers = dict[str, NDArray[Any]]


@cache
def good_clips() -> tuple[tuple[str, bytes, str], ...]:
    """(document, buffers, header) of small clips of every kind, as they lie in a file."""
    import tempfile
    from pathlib import Path

    kinds = [
        _clip(1, 40, False, Motion.FALL),
        _clip(2, 30, True, Motion.FADE),
        _clip(3, 20, True, Motion.REMOVE, precision="float32", held_out=True),
        _clip(1, 1, False, Motion.MOVE),
        _clip(2, 300, False, Motion.FALL, spacing=1e-6),
        _clip(1, 10, False, Motion.MOVE, tracks=20_000),
    ]
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for clip in kinds:
            clip.save(Path(folder, "good.gclip"))
            content = Path(folder, "good.gclip").read_bytes()
            length = 8 + int.from_bytes(content[:8], "little")
            header = json.loads(content[8:length])
            found.append(
                (header.pop("__metadata__")["gclip"], content[length:], json.dumps(header))
            )
    return tuple(found)


def _clip(
    degree: int,
    count: int,
    colors: bool,
    lost: Motion,
    precision: str = "auto",
    spacing: float = 5.0,
    held_out: bool = False,
    tracks: int = 2,
) -> Clip:
    random = np.random.default_rng(count)
    times, names = (0.0, 2.0, 5.0, 6.5), ("2020-03-08", "2020-03-10", "2020-03-13", "later")
    ids = np.sort(random.integers(0, 2, count)) + tracks - 2
    intervals = []
    for k, motion in enumerate((Motion.MOVE, lost, Motion.MOVE)):
        curve = tuple(random.random((count, 3)) * 100 for _ in range(degree + 1))
        paint = [random.integers(0, 256, (count, 4), np.uint8) if colors else None] * 2
        movers = [Movers(motion, curve, ids, *paint)]
        if motion is not Motion.MOVE and count > 1:
            half = [
                Movers(
                    m,
                    tuple(p[s] for p in curve),
                    ids[s],
                    *(c if c is None else c[s] for c in paint),
                )
                for m, s in ((Motion.MOVE, slice(0, 1)), (motion, slice(1, None)))
            ]
            movers = half
        packed = pack_interval(times[k], times[k + 1], movers, spacing=spacing, precision=precision)
        wide = packed.tracks.astype(np.uint32) if tracks > 2 else packed.tracks
        intervals.append(replace(packed, tracks=wide))
    points = random.random((7, 3)).astype(np.float32)
    few = [Track(i, f"organ {i}", (90, 160, 60), parent=i - 1 if i else None) for i in range(2)]
    return Clip(
        scans=tuple(ScanMark(f"{n}.ply", t, n, count) for n, t in zip(names, times, strict=True)),
        intervals=tuple(intervals),
        track_table=tuple(few if tracks == 2 else [few[0]] * tracks),
        unit="mm",
        spacing=spacing,
        held_out=(ScanMark("x.ply", 3.0, "2020-03-11", len(points), points),) if held_out else (),
        provenance={"notes": ["made by hand"], "options": {"align": "auto", "k": [15, 2.5]}},
    )


def hostile(random: Random) -> bytes:
    """One file."""
    few = good_clips()[:-1]
    text, content, listed = random.choice(few) if random.random() < 0.9995 else good_clips()[-1]
    if random.random() < 0.001:
        return _contained(random.choice(BOMBS)(random), content, listed)
    if random.random() < 0.1:
        text = _extreme(text, random)
    for _ in range(random.choice((0, 1, 1, 1, 2, 3))):
        text = _spoiled_document(text, random)
    if random.random() < 0.3:
        content = _spoiled_bytes(content, random)
    if random.random() < 0.12:
        listed = _spoiled_header(listed, random)
    file = _contained(text, content, listed)
    return _spoiled_file(file, random) if random.random() < 0.2 else file


def _contained(text: str, content: bytes, listed: str) -> bytes:
    """A container of a document, buffers, and the header that lists them."""
    entries = listed.strip()[1:]
    comma = "," if entries.strip() != "}" else ""
    metadata = json.dumps({"gclip": text})
    header = f'{{"__metadata__":{metadata}{comma}{entries}'.encode("utf-8", "surrogatepass")
    return len(header).to_bytes(8, "little") + header + content


def _spoiled_document(text: str, random: Random) -> str:
    """Some of its values replaced, removed, doubled or moved; or its very text."""
    way = random.random()
    if way < 0.1:
        place = random.randrange(len(text))
        return text[:place] + random.choice(RAW) + text[place + random.choice((0, 0, 1, 9)) :]
    if way < 0.13:
        return text.replace('"degree":', '"degree":1,"degree":', 1)
    try:
        document = json.loads(text)
    except (ValueError, RecursionError):
        return text
    places = list(_places(document))
    if not places:
        return text
    holder, key = random.choice(places)
    change = random.choice(("value", "value", "value", "near", "drop", "double", "move"))
    if change == "value":
        holder[key] = copy.deepcopy(random.choice(VALUES))
    elif change == "near":
        holder[key] = _near(holder[key], random)
    elif change == "drop":
        del holder[key]
    elif change == "double" and isinstance(holder, list):
        holder.insert(key, copy.deepcopy(holder[key]))
    else:
        other, place = random.choice(places)
        holder[key] = copy.deepcopy(other[place])
    try:
        return json.dumps(document, ensure_ascii=random.random() < 0.5)
    except (ValueError, RecursionError):
        return text


def _extreme(text: str, random: Random) -> str:
    """Within the rules, and as far out as they let one go."""
    document = json.loads(text)
    low, high = random.choice(
        ((-1e18, 1e18), (1e18, 1e18), (0.0, 5e-324), (0.0, 1e-30), (-1e18, 0.0), (3.0, 3.0))
    )
    for box in [interval["box"] for interval in document["intervals"] if interval["box"]]:
        box["low"], box["high"] = [low] * 3, [high] * 3
    for key in ("spacing", "floor"):
        document[key] = random.choice((document[key], 0.0, 5e-324, 1e-30, 1e18))
    document["origin"] = random.choice(([0.0] * 3, [1e18, -1e18, 1e18]))
    scale, shift = random.choice(((1.0, 0.0), (1e17, -5e17), (1e-9, 0.0), (1.0, 1e9)))
    moments = [*document["scans"], *document.get("held_out", ())]
    for holder, keys in [(m, ("time",)) for m in moments] + [
        (interval, ("start", "end")) for interval in document["intervals"]
    ]:
        holder |= {key: holder[key] * scale + shift for key in keys}
    for scan in document["scans"]:
        scan["points"] = random.choice((0, 1, scan["points"], 2**48 - 1))
    return json.dumps(document)


def _near(value: Any, random: Random) -> Any:
    """Almost the same: what a check that is off by one lets pass."""
    if isinstance(value, int):
        return value + random.choice((-1, 1, 2))
    if isinstance(value, float):
        return random.choice(
            (-value, value + 1.0, value * 1e-300, value * 1e17, float(np.nextafter(value, 9)))
        )
    if isinstance(value, str):
        return value + random.choice(INJECTIONS)
    if isinstance(value, list):
        return value[::-1] if random.random() < 0.5 else value[1:]
    return value


def _places(value: Any) -> Any:
    """(holder, key) of every value in a document, few of each long list."""
    if isinstance(value, dict):
        keys: Any = value
    elif isinstance(value, list):
        keys = range(min(len(value), 12))
    else:
        return
    for key in list(keys):
        yield value, key
        yield from _places(value[key])


def _spoiled_header(listed: str, random: Random) -> str:
    entries = json.loads(listed)
    name = random.choice(sorted(entries))
    entry = entries[name]
    length = max(end["data_offsets"][1] for end in entries.values())
    way = random.randrange(10)
    if way == 0:
        entry["dtype"] = random.choice(KINDS)
    elif way == 1:
        entry["shape"] = random.choice(
            ([], [0], [2**62, 4], [2**64], [-1, 3], [1] * 70, [1.5], entry["shape"][::-1], "x")
        )
    elif way == 2:
        entry["data_offsets"] = random.choice(
            (
                [0, 2**64],
                [-4, 4],
                [8, 4],
                [0, length],
                [length, length + 8],
                [0],
                [2**63, 2**63],
                "x",
            )
        )
    elif way == 3:
        shift = random.choice((-6, -1, 1, 6))
        entry["data_offsets"] = [offset + shift for offset in entry["data_offsets"]]
    elif way == 4:
        del entries[name]
    elif way == 5:
        entries[random.choice(("0000/start", "9999/end", "x" * 500, "\x1b[2J", "0003/track"))] = (
            entry
        )
    elif way == 6:
        other = random.choice(sorted(entries))
        entries[name], entries[other] = entries[other], entries[name]
    elif way == 7:
        entries[name] = random.choice(VALUES[:20])
    elif way == 8:
        double = json.dumps({name: entry})[1:-1]
        return json.dumps(entries)[:-1] + f", {double}}}"
    else:
        flood = random.choice((10, 1_000, 20_000))
        empty = {"dtype": "U8", "shape": [0], "data_offsets": [length, length]}
        entries |= {f"x{i}": empty for i in range(flood)}
    return json.dumps(entries)


def _spoiled_bytes(content: bytes, random: Random) -> bytes:
    """Ids out of range, positions that are none, anything."""
    damaged = bytearray(content)
    for _ in range(random.choice((1, 1, 5, 50))):
        place = random.randrange(len(damaged))
        length = random.choice((1, 2, 4, 12, 400))
        filled = random.choice((b"\xff", b"\x00", b"\x7f", b"\x80", random.randbytes(1)))
        some = len(damaged[place : place + length])
        damaged[place : place + some] = filled * some
    return bytes(damaged)


def _spoiled_file(file: bytes, random: Random) -> bytes:
    damaged = bytearray(file)
    way = random.randrange(7)
    if way == 0:
        del damaged[random.randrange(len(damaged)) :]
    elif way == 1:
        damaged += random.randbytes(random.choice((1, 8, 5_000)))
    elif way == 2:
        lengths = (0, 1, 2**63, 2**64 - 1, len(file), len(file) - 8, len(file) - 7, 100_000_001)
        damaged[:8] = random.choice(lengths).to_bytes(8, "little")
    elif way == 3:
        place = random.randrange(len(damaged))
        del damaged[place : place + random.choice((1, 2, 8, 100))]
    elif way == 4:
        place = random.randrange(len(damaged))
        damaged[place:place] = random.randbytes(random.choice((1, 2, 8)))
    else:
        for _ in range(random.choice((1, 1, 2, 8, 100))):
            first = len(damaged) if random.random() < 0.3 else min(3_000, len(damaged))
            damaged[random.randrange(first)] ^= 1 << random.randrange(8)
    return bytes(damaged)


def _many(
    piece: str, opened: str = '{"version":"1.0","provenance":{"x":[', closed: str = "0]}}"
) -> Callable:
    """A document that repeats a piece until it is some megabytes long."""

    def document(random: Random) -> str:
        size = random.choice((50_000, 500_000, 3_000_000, 9_000_000))
        return opened + piece * (size // len(piece)) + closed

    return document


def _keys(random: Random) -> str:
    count = random.choice((1_000, 90_000, 300_000))
    return '{"version":"1.0","provenance":{' + ",".join(f'"k{i}":{i}' for i in range(count)) + "}}"


def _wide(random: Random) -> str:
    """One wide character makes CPython keep all of a text in four bytes each."""
    count = random.choice((100_000, 4_000_000, 8_000_000))
    return '{"version":"1.0","unit":"🌱' + "x" * count + '"}'


def _scans(random: Random) -> str:
    """Well formed, and many: what is quadratic takes for ever."""
    count = random.choice((100, 3_000, 30_000))
    document = json.loads(good_clips()[0][0])
    document["scans"] = [
        {"name": f"s{i}", "time": i * 6.5 / (count - 1), "date": f"d{i}", "points": 1}
        for i in range(count)
    ]
    document["tracks"] = document["tracks"] * (count // 2)
    return json.dumps(document)


BOMBS: tuple[Callable[[Random], str], ...] = (
    *(_many(piece) for piece in ("[],", "{},", '{"a":1},', "1.5,", '"ab",', "123456789,", '"🌱",')),
    _many('{"name":"s","time":0,"points":0},', '{"version":"1.0","scans":[', "{}]}"),
    _many(
        '{"first":0,"count":0,"motion":"move"},',
        '{"version":"1.0","intervals":[{"groups":[',
        "{}]}]}",
    ),
    *(_keys, _wide, _scans),
)
