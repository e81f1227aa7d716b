"""The safetensors container: a JSON document and named buffers, as views of a mapped file."""

from __future__ import annotations

import math
import mmap
import os
import stat
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.errors import ClipError
from gclip.text import printable

KEY = "gclip"
DTYPES = {"U8": np.uint8, "U16": np.uint16, "U32": np.uint32, "F32": np.float32}
LONGEST_HEADER = 8 << 20  # bytes, and a quarter of the file: a clip is movers before all
ATTEMPTS = 5  # at a file that is replaced while it is opened


@dataclass(frozen=True)
class Slot:
    """Where a buffer lies: from byte `first` of the file on."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    first: int

    @property
    def size(self) -> int:
        """In bytes."""
        return math.prod(self.shape) * self.dtype.itemsize


class Container:
    """An open file. `document` is its text, `layout` says which buffers there are.

    Nothing of them is read before it is asked for. `size` is the file's, in bytes.
    """

    def __init__(self, document: str, layout: dict[str, Slot], data: NDArray[np.uint8]) -> None:
        self.document = document
        self.layout = layout
        self.size = len(data)
        self._data = data

    def buffer(self, name: str) -> NDArray[Any]:
        """A buffer as a view of the mapped file, of its dtype and one axis."""
        slot = self.layout[name]
        return self._data[slot.first : slot.first + slot.size].view(slot.dtype)


class Mapped(mmap.mmap):
    """A file in memory; `name` is its path."""

    name: str


def check_whole(buffer: NDArray[Any]) -> None:
    """Raise ClipError where the file that a buffer is mapped from was cut short in the meantime.

    To be asked before a buffer is read: memory beyond the end of a file ends the program (SIGBUS).
    Buffers that are no file's are whole.
    """
    base: Any = buffer
    while isinstance(base, np.ndarray):
        base = base.base
    mapped = getattr(base, "obj", base)
    if isinstance(mapped, Mapped) and mapped.size() < len(mapped):
        raise ClipError(printable(f"{mapped.name}: it was cut short while it was open."))


def open_container(path: Path) -> Container:
    """Map a file. Raises ClipError, without the file's name, where it is no whole container."""
    if "\0" in os.fspath(path):
        raise ClipError("no such file")
    try:
        for _ in range(ATTEMPTS):
            found = _mapped(path)
            if found is not None:
                return found
    except FileNotFoundError:
        raise ClipError("no such file") from None
    except OSError as error:
        raise ClipError(f"it can't be read: {error.strerror or error}") from None
    raise ClipError("it is being written right now; try again")


def _mapped(path: Path) -> Container | None:
    """None where another file took its place in the middle of this."""
    if not stat.S_ISREG(os.stat(path).st_mode):
        raise ClipError("not a growth clip, not even a file")
    with open(path, "rb") as file:
        before = os.fstat(file.fileno())
        length = header_length(file.read(8), before.st_size)
        document, layout = _header(path, 8 + length)
        mapped = Mapped(file.fileno(), 0, access=mmap.ACCESS_READ)
        mapped.name = os.fspath(path)
        after = os.stat(path)
    if _mark(before) != _mark(after) or len(mapped) != before.st_size:
        return None
    return Container(document, layout, np.frombuffer(mapped, np.uint8))


def header_length(start: bytes, size: int) -> int:
    """Checked before anything of such a length is read."""
    length = int.from_bytes(start, "little")
    if len(start) < 8 or length > size - 8:
        raise ClipError("not a growth clip, or cut short within its header")
    if length > LONGEST_HEADER + size // 4:
        raise ClipError(f"its header is {length} bytes long, too much for a file of {size}")
    return length


def _header(path: Path, first: int) -> tuple[str, dict[str, Slot]]:
    """The document and the layout of the buffers, which begin at byte `first`.

    safetensors checks the header: buffers inside the file, in order, no holes, no overlaps.
    So each one begins where the last one ended.
    """
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(path, framework="numpy") as container:
            document = (container.metadata() or {}).get(KEY)
            if document is None:
                raise ClipError('not a growth clip: a safetensors file without the key "gclip"')
            layout: dict[str, Slot] = {}
            for name in container.offset_keys():
                view = container.get_slice(name)
                layout[name] = slot = _slot(name, view.get_dtype(), view.get_shape(), first)
                first += slot.size
    except SafetensorError as error:
        reason = printable(str(error), 200)
        raise ClipError(f"not a growth clip, or cut short or damaged ({reason})") from None
    return document, layout


def _slot(name: str, kind: str, shape: Sequence[int], first: int) -> Slot:
    if kind not in DTYPES:
        allowed = ", ".join(DTYPES)
        raise ClipError(f'its buffer "{name[:40]}" is of type {kind}; {allowed} allowed')
    return Slot(np.dtype(DTYPES[kind]), tuple(shape), first)


def _mark(state: os.stat_result) -> tuple[int, ...]:
    """Differs where the file does."""
    return state.st_dev, state.st_ino, state.st_size, state.st_mtime_ns
