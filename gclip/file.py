"""Reading and writing `.gclip` files: a safetensors container with one JSON document.

Nothing but numbers is stored, and no code runs on opening. See docs/format.md.
"""

from __future__ import annotations

import os
import stat
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.clip import Clip, HeldOutScan, Interval, ScanMark
from gclip.document import IntervalHeader, from_json, to_json
from gclip.errors import ClipError

KEY = "gclip"
DTYPES = {"U8": np.uint8, "U16": np.uint16, "U32": np.uint32, "F32": np.float32}


def save_clip(clip: Clip, path: str | os.PathLike[str]) -> None:
    """Write `clip` to `path` in one step: a temporary file beside it, flushed, then renamed.

    Raises ClipError where the folder is missing or can't be written; `path` is then as it was.
    """
    from safetensors.numpy import save_file

    target = Path(path)
    tensors = {
        name: np.ascontiguousarray(buffer)
        for index, interval in enumerate(clip.intervals)
        for name, buffer in _buffers(index, interval).items()
    }
    for index, scan in enumerate(clip.held_out):
        tensors[_held_out_name(index)] = np.ascontiguousarray(scan.positions, np.float32)
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        os.close(handle)
        try:
            save_file(tensors, temporary, {KEY: to_json(clip)})
            _finish(temporary, target)
        except BaseException:
            Path(temporary).unlink(missing_ok=True)
            raise
    except Exception as error:
        if isinstance(error, OSError) or type(error).__name__ == "SafetensorError":
            reason = getattr(error, "strerror", None) or str(error)
            raise ClipError(f"{target} can't be written: {reason}.") from None
        raise


def _finish(temporary: str, target: Path) -> None:
    umask = os.umask(0)
    os.umask(umask)
    os.chmod(temporary, 0o666 & ~umask)
    with open(temporary, "rb") as written:
        os.fsync(written.fileno())
    os.replace(temporary, target)


def open_clip(path: str | os.PathLike[str]) -> Clip:
    """Open a clip, memory-mapped; everything the file says is checked before it is returned.

    Raises ClipError with one sentence that names the file and what is wrong with it.
    """
    try:
        return _open(Path(path))
    except ClipError as error:
        raise ClipError(f"{os.fspath(path)}: {error}.") from None


def _open(path: Path) -> Clip:
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise ClipError("not a growth clip, not even a file")
        document, buffers = _map_container(path)
    except FileNotFoundError:
        raise ClipError("no such file") from None
    except OSError as error:
        raise ClipError(f"it can't be read: {error.strerror or error}") from None
    clip, headers, marks = from_json(document)
    intervals = tuple(
        _interval(index, header, buffers, len(clip.track_table))
        for index, header in enumerate(headers)
    )
    held_out = tuple(_held_out(index, mark, buffers) for index, mark in enumerate(marks))
    if buffers:
        raise ClipError(f'it holds a buffer "{next(iter(buffers))[:40]}" that nothing names')
    return replace(clip, intervals=intervals, held_out=held_out)


def _map_container(path: Path) -> tuple[str, dict[str, NDArray[Any]]]:
    """The document and the buffers as views of the memory-mapped file.

    safetensors checks the header: buffers inside the file, in order, no holes, no overlaps.
    So each one begins where the last one ended.
    """
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="numpy") as container:
            document = (container.metadata() or {}).get(KEY)
            if document is None:
                raise ClipError('not a growth clip: a safetensors file without the key "gclip"')
            layout = []
            for name in container.offset_keys():
                view = container.get_slice(name)
                layout.append((name, view.get_dtype(), tuple(view.get_shape())))
    except SafetensorError as error:
        raise ClipError(f"not a growth clip, or cut short or damaged ({error})") from None
    data: NDArray[np.uint8] = np.memmap(path, np.uint8, mode="r")
    first = 8 + int.from_bytes(data[:8].tobytes(), "little")
    buffers: dict[str, NDArray[Any]] = {}
    for name, kind, shape in layout:
        if kind not in DTYPES:
            raise ClipError(
                f'its buffer "{name[:40]}" is of type {kind}; {", ".join(DTYPES)} allowed'
            )
        dtype = np.dtype(DTYPES[kind])
        size = int(np.prod(shape, dtype=object)) * dtype.itemsize
        buffers[name] = data[first : first + size].view(dtype).reshape(shape)
        first += size
    return document, buffers


def _names(index: int, degree: int) -> list[str]:
    """The names of an interval's position buffers, from start to end."""
    controls = [f"{index:04d}/control{i}" for i in range(1, degree)]
    return [f"{index:04d}/start", *controls, f"{index:04d}/end"]


def _buffers(index: int, interval: Interval) -> dict[str, NDArray[Any]]:
    buffers = dict(zip(_names(index, interval.degree), interval.curve, strict=True))
    buffers[f"{index:04d}/track"] = interval.tracks
    if interval.start_colors is not None and interval.end_colors is not None:
        buffers[f"{index:04d}/start_color"] = interval.start_colors
        buffers[f"{index:04d}/end_color"] = interval.end_colors
    return buffers


def _interval(
    index: int, header: IntervalHeader, buffers: dict[str, NDArray[Any]], tracks: int
) -> Interval:
    count = header.groups[-1].stop
    names = _names(index, header.degree)
    kind = np.float32 if header.box is None else np.uint16
    curve = [_take(buffers, name, (count, 3), (kind,)) for name in names]
    if header.box is None:
        for name, points in zip(names, curve, strict=True):
            if not np.isfinite(points).all():
                raise ClipError(f'its buffer "{name}" holds a position that is not finite')
    ids = _take(buffers, f"{index:04d}/track", (count,), (np.uint16, np.uint32))
    if count and int(ids.max()) >= tracks:
        raise ClipError(
            f'its buffer "{index:04d}/track" names track {int(ids.max())}; '
            f"only {tracks} tracks are named"
        )
    colors: list[NDArray[np.uint8] | None] = [None, None]
    if f"{index:04d}/start_color" in buffers or f"{index:04d}/end_color" in buffers:
        colors = [
            _take(buffers, f"{index:04d}/{end}_color", (count, 4), (np.uint8,))
            for end in ("start", "end")
        ]
    return Interval(
        start=header.start,
        end=header.end,
        box=header.box,
        groups=header.groups,
        start_positions=curve[0],
        end_positions=curve[-1],
        control_positions=tuple(curve[1:-1]),
        tracks=ids,
        start_colors=colors[0],
        end_colors=colors[1],
        segments=header.segments,
    )


def _held_out_name(index: int) -> str:
    return f"held_out/{index:04d}"


def _held_out(index: int, mark: ScanMark, buffers: dict[str, NDArray[Any]]) -> HeldOutScan:
    name = _held_out_name(index)
    positions = _take(buffers, name, (mark.points, 3), (np.float32,))
    if not np.isfinite(positions).all():
        raise ClipError(f'its buffer "{name}" holds a position that is not finite')
    return HeldOutScan(mark.name, mark.time, mark.date, positions)


def _take(
    buffers: dict[str, NDArray[Any]], name: str, shape: tuple[int, ...], kinds: tuple[type, ...]
) -> NDArray[Any]:
    if name not in buffers:
        raise ClipError(f'its buffer "{name}" is missing')
    buffer = buffers.pop(name)
    if buffer.shape != shape or buffer.dtype.type not in kinds:
        allowed = " or ".join(np.dtype(kind).name for kind in kinds)
        raise ClipError(
            f'its buffer "{name}" is {buffer.dtype.name} {buffer.shape}, '
            f"not {allowed} {shape} as the document needs"
        )
    return buffer
