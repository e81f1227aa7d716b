"""Read files of clips: a safetensors container with a JSON document (docs/format.md).

No code from the file is executed; buffers are views of the memory-mapped file.
"""

import math
import os
import stat
from dataclasses import dataclass, replace
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.errors import ClipError
from gclip.schema import CURVES, MAX_NUMBER, OPTIONAL, Interval
from gclip.text import printable

KEY = "gclip"
DTYPES = {"U8": np.uint8, "U16": np.uint16, "U32": np.uint32, "F32": np.float32}
identity = attrgetter("st_dev", "st_ino", "st_size", "st_mtime_ns")  # changes if the file does


@dataclass(frozen=True)
class Container:
    """An open file."""

    text: str  #: the document
    buffers: dict[str, NDArray[Any]]  #: read-only views of the file, by name
    size: int  #: of the file, in bytes

    def take(self, name: str, shape: tuple[int, ...], *dtypes: type) -> NDArray[Any]:
        """The buffer of a name. Raises ClipError unless it has this shape and one of the dtypes."""
        buffer = self.buffers.get(name)
        if buffer is None or buffer.shape != shape or buffer.dtype.type not in dtypes:
            found = "missing" if buffer is None else f"{buffer.dtype.name} {buffer.shape}"
            needed = f"{' or '.join(np.dtype(dtype).name for dtype in dtypes)} {shape}"
            raise ClipError(f'its buffer "{name}" is {found}; the document needs {needed}')
        return buffer

    def positions(self, name: str, count: int) -> NDArray[np.float32]:
        """A buffer of (count, 3) local positions. Raises ClipError unless they are finite."""
        points = self.take(name, (count, 3), np.float32)
        # Comparisons with NaN, which is the minimum and maximum of an array with NaN, are False.
        if count and not (points.min() >= -MAX_NUMBER and points.max() <= MAX_NUMBER):
            found = f"a position that is not finite, or beyond {MAX_NUMBER:g}"
            raise ClipError(f'its buffer "{name}" holds {found}')
        return points


def open_container(path: Path) -> Container:
    """Map a file. Raises ClipError, without the file's name, if it is not a complete container.

    safetensors checks that the buffers follow each other without gaps up to the end of the file.
    """
    from safetensors import SafetensorError, safe_open

    buffers = {}
    try:
        before = os.stat(path)
        if not stat.S_ISREG(before.st_mode):
            raise ClipError("not a growth clip, not even a file")
        data = np.asarray(np.memmap(path, np.uint8, "r"))
        first = 8 + int.from_bytes(data[:8].tobytes(), "little")  # byte of the first buffer
        with safe_open(path, framework="numpy") as header:
            text = (header.metadata() or {}).get(KEY)
            if text is None:
                raise ClipError('not a growth clip: a safetensors file without the key "gclip"')
            for name in header.offset_keys():
                view = header.get_slice(name)
                kind, shape = view.get_dtype(), view.get_shape()
                if kind not in DTYPES:
                    found = f'its buffer "{name[:40]}" is of type {kind}'
                    raise ClipError(f"{found}; {', '.join(DTYPES)} are allowed")
                end = first + math.prod(shape) * np.dtype(DTYPES[kind]).itemsize
                buffers[name] = data[first:end].view(DTYPES[kind]).reshape(shape)
                first = end
        if identity(before) != identity(os.stat(path)):
            raise ClipError("it is being written right now; try again")
    except FileNotFoundError:
        raise ClipError("no such file") from None
    except OSError as error:
        raise ClipError(f"it can't be read: {error.strerror or error}") from None
    except (SafetensorError, ValueError) as error:
        reason = printable(str(error), 200)
        raise ClipError(f"not a growth clip, or cut short or damaged ({reason})") from None
    return Container(text, buffers, len(data))


def read_interval(container: Container, index: int, entry: Interval, tracks: int) -> Interval:
    """Read the buffers of an interval and check them.

    Parameters
    ----------
    container : Container
    index : int
        Number of the interval, from which its buffers are named.
    entry : Interval
        As the document has it; its own buffers are ignored.
    tracks : int
        Number of tracks of the clip.

    Raises
    ------
    ClipError
        If a buffer is missing, has another shape or type, or holds wrong values.
    """
    count, folder = entry.groups[-1].stop, f"{index:04d}/"
    names = [folder + name for name in CURVES[entry.degree]]
    if entry.box is None:
        curve = [container.positions(name, count) for name in names]
    else:
        curve = [container.take(name, (count, 3), np.uint16) for name in names]
    ids = container.take(f"{folder}track", (count,), np.uint16, np.uint32)
    if (largest := int(ids.max())) >= tracks:
        found = f'its buffer "{folder}track" names track {largest}'
        raise ClipError(f"{found}; only {tracks} tracks are named")
    optional: dict[str, Any] = {
        field: container.take(folder + name, (count, 4), np.uint8)
        for field, name in OPTIONAL.items()
        if folder + name in container.buffers
    }
    if len(optional.keys() & {"start_colors", "end_colors"}) == 1:
        raise ClipError(f"one of its buffers {folder}start_color and {folder}end_color is missing")
    return replace(entry, curve=tuple(curve), tracks=ids, **optional)
