"""Reading and writing `.gclip` files: a safetensors container with one JSON document.

Nothing but numbers is stored, and no code runs on opening. See docs/format.md.
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.clip import Clip, HeldOutScan, Interval
from gclip.container import KEY, Container, open_container
from gclip.document import IntervalHeader, checksum, from_json, to_json
from gclip.draft import draft_file
from gclip.errors import ClipError
from gclip.fields import LARGEST
from gclip.text import printable


def save_clip(clip: Clip, path: str | os.PathLike[str]) -> None:
    """Write `clip` to `path` in one step: a temporary file beside it, flushed, then renamed.

    Raises ClipError where the folder is missing or can't be written, or where the clip says what
    `open_clip` would refuse; `path` is then as it was.
    """
    from safetensors.numpy import save_file

    target = Path(path)
    tensors = _tensors(clip)
    document = to_json(clip, {name: checksum(buffer) for name, buffer in tensors.items()})
    try:
        from_json(document, len(document) + sum(buffer.nbytes for buffer in tensors.values()))
    except ClipError as error:
        raise ClipError(printable(f"{target} can't be written: {error}.")) from None
    try:
        with draft_file(target) as part:
            save_file(tensors, part, {KEY: document})
    except Exception as error:
        if isinstance(error, OSError) or type(error).__name__ == "SafetensorError":
            reason = getattr(error, "strerror", None) or str(error)
            reason = re.sub(r".*I/O error: (.*) \(os error \d+\)", r"\1", reason)
            raise ClipError(f"{target} can't be written: {reason}.") from None
        raise


def _tensors(clip: Clip) -> dict[str, NDArray[Any]]:
    """All buffers of a clip by name, in C order."""
    buffers: dict[str, NDArray[Any]] = {}
    for index, interval in enumerate(clip.intervals):
        buffers |= _buffers(index, interval)
    for index, scan in enumerate(clip.held_out):
        buffers[_held_out_name(index)] = np.asarray(scan.positions, np.float32)
    return {name: np.ascontiguousarray(buffer) for name, buffer in buffers.items()}


def open_clip(path: str | os.PathLike[str]) -> Clip:
    """Open a clip, memory-mapped; everything the file says is checked before it is returned.

    Its checksums are not: that would read all of it (see `gclip.check`).
    Raises ClipError with one sentence that names the file and what is wrong with it.
    """
    try:
        return clip_in(open_container(Path(path)))
    except ClipError as error:
        raise ClipError(printable(f"{os.fspath(path)}: {error}.")) from None


def clip_in(container: Container) -> Clip:
    """The clip that a container holds. Raises ClipError without the file's name."""
    clip, headers, marks = from_json(container.document, container.size)
    buffers = _Buffers(container)
    intervals = tuple(
        _interval(index, header, buffers, len(clip.track_table))
        for index, header in enumerate(headers)
    )
    held_out = tuple(
        HeldOutScan(mark.name, mark.time, mark.date, _positions(buffers, name, mark.points))
        for mark, name in ((mark, _held_out_name(index)) for index, mark in enumerate(marks))
    )
    if buffers.left:
        raise ClipError(f'it holds a buffer "{min(buffers.left)[:40]}" that nothing names')
    return replace(clip, intervals=intervals, held_out=held_out)


class _Buffers:
    """A container's buffers, each taken once; `left` are the names of the others."""

    def __init__(self, container: Container) -> None:
        self._container = container
        self.left = set(container.layout)

    def take(self, name: str, shape: tuple[int, ...], kinds: tuple[type, ...]) -> NDArray[Any]:
        """The buffer of that name, if it is what is expected."""
        if name not in self.left:
            raise ClipError(f'its buffer "{name}" is missing')
        self.left.remove(name)
        slot = self._container.layout[name]
        if slot.shape != shape or slot.dtype.type not in kinds:
            allowed = " or ".join(np.dtype(kind).name for kind in kinds)
            raise ClipError(
                f'its buffer "{name}" is {slot.dtype.name} {_shown(slot.shape)}, '
                f"not {allowed} {_shown(shape)} as the document needs"
            )
        return self._container.buffer(name).reshape(shape)


def _interval(index: int, header: IntervalHeader, buffers: _Buffers, tracks: int) -> Interval:
    count = header.groups[-1].stop
    curve = [
        _positions(buffers, name, count)
        if header.box is None
        else buffers.take(name, (count, 3), (np.uint16,))
        for name in _names(index, header.degree)
    ]
    ids = buffers.take(f"{index:04d}/track", (count,), (np.uint16, np.uint32))
    if int(ids.max()) >= tracks:
        raise ClipError(
            f'its buffer "{index:04d}/track" names track {int(ids.max())}; '
            f"only {tracks} tracks are named"
        )
    paint: list[NDArray[np.uint8] | None] = [None, None]
    names = [f"{index:04d}/{end}_color" for end in ("start", "end")]
    if not buffers.left.isdisjoint(names):
        paint = [buffers.take(name, (count, 4), (np.uint8,)) for name in names]
    return Interval(
        start=header.start,
        end=header.end,
        box=header.box,
        groups=header.groups,
        start_positions=curve[0],
        end_positions=curve[-1],
        control_positions=tuple(curve[1:-1]),
        tracks=ids,
        start_colors=paint[0],
        end_colors=paint[1],
        segments=header.segments,
    )


def _positions(buffers: _Buffers, name: str, count: int) -> NDArray[np.float32]:
    """(count, 3) positions that are numbers; the lowest and the highest tell, also of NaN."""
    points = buffers.take(name, (count, 3), (np.float32,))
    if count and not (points.min() >= -LARGEST and points.max() <= LARGEST):
        raise ClipError(
            f'its buffer "{name}" holds a position that is not finite, or beyond {LARGEST:g}'
        )
    return points


def _names(index: int, degree: int) -> list[str]:
    """The names of an interval's position buffers, from start to end."""
    controls = [f"{index:04d}/control{i}" for i in range(1, degree)]
    return [f"{index:04d}/start", *controls, f"{index:04d}/end"]


def _held_out_name(index: int) -> str:
    return f"held_out/{index:04d}"


def _buffers(index: int, interval: Interval) -> dict[str, NDArray[Any]]:
    buffers = dict(zip(_names(index, interval.degree), interval.curve, strict=True))
    buffers[f"{index:04d}/track"] = interval.tracks
    if interval.start_colors is not None and interval.end_colors is not None:
        buffers[f"{index:04d}/start_color"] = interval.start_colors
        buffers[f"{index:04d}/end_color"] = interval.end_colors
    return buffers


def _shown(shape: tuple[int, ...]) -> str:
    return str(shape) if len(shape) < 4 else f"of {len(shape)} axes"
