"""Read and write files of clips: a safetensors container with a JSON document (docs/format.md).

No code from the file is executed; buffers are views of the memory-mapped file.
"""

import math
import mmap
import os
import re
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip.errors import ClipError, UserError
from gclip.terminal.atomic import atomic_file
from gclip.text import printable

KEY = "gclip"
DTYPES = {"U8": np.uint8, "U16": np.uint16, "U32": np.uint32, "F32": np.float32}
MAX_HEADER = 8 << 20  # bytes, plus a quarter of the file
identity = attrgetter("st_dev", "st_ino", "st_size", "st_mtime_ns")  # changes if the file does


@dataclass(frozen=True)
class Container:
    """An open file."""

    text: str  #: the document
    buffers: dict[str, NDArray[Any]]  #: read-only views of the file, by name
    size: int  #: of the file, in bytes
    unread: set[str]  #: names of the buffers that `take` has not returned yet

    def take(self, name: str, shape: tuple[int, ...], *dtypes: type) -> NDArray[Any]:
        """The buffer of a name. Raises ClipError unless it has this shape and one of the dtypes."""
        if name not in self.buffers:
            raise ClipError(f'its buffer "{name}" is missing')
        buffer = self.buffers[name]
        if buffer.shape != shape or buffer.dtype.type not in dtypes:
            found = f"{buffer.dtype.name} {buffer.shape}"
            needed = f"{' or '.join(np.dtype(dtype).name for dtype in dtypes)} {shape}"
            raise ClipError(f'its buffer "{name}" is {found}, not {needed} as the document needs')
        self.unread.discard(name)
        return buffer


class Mapped(mmap.mmap):
    """A memory-mapped file with its name."""

    name: str


def check_not_truncated(buffer: NDArray[Any]) -> None:
    """Raise ClipError if the file that a buffer is mapped from was truncated after it was opened.

    Call it before reading a buffer: an access beyond the end of the file ends the process (SIGBUS).
    """
    base: Any = buffer
    while isinstance(base, np.ndarray):
        base = base.base
    mapped = getattr(base, "obj", base)
    if isinstance(mapped, Mapped) and mapped.size() < len(mapped):
        raise ClipError(f"{mapped.name}: it was cut short while it was open.")


def open_container(path: Path) -> Container:
    """Map a file. Raises ClipError, without the file's name, if it is not a complete container."""
    try:
        before = os.stat(path)
        if not stat.S_ISREG(before.st_mode):
            raise ClipError("not a growth clip, not even a file")
        with open(path, "rb") as file:
            length = _header_length(file.read(8), before.st_size)
            mapped = Mapped(file.fileno(), 0, access=mmap.ACCESS_READ)
        mapped.name = os.fspath(path)
        text, buffers = _read_header(path, np.frombuffer(mapped, np.uint8), 8 + length)
        if identity(before) != identity(os.stat(path)):
            raise ClipError("it is being written right now; try again")
    except (FileNotFoundError, ValueError):  # ValueError: a name with a null character
        raise ClipError("no such file") from None
    except OSError as error:
        raise ClipError(f"it can't be read: {error.strerror or error}") from None
    return Container(text, buffers, len(mapped), set(buffers))


def _header_length(start: bytes, size: int) -> int:
    length = int.from_bytes(start, "little")
    if len(start) < 8 or length > size - 8:
        raise ClipError("not a growth clip, or cut short within its header")
    if length > MAX_HEADER + size // 4:
        raise ClipError(f"its header is {length} bytes long, too much for a file of {size}")
    return length


def _read_header(
    path: Path, data: NDArray[np.uint8], first: int
) -> tuple[str, dict[str, NDArray[Any]]]:
    """Read the document of a file, and map its buffers, of which the first is at byte `first`.

    safetensors checks that the buffers follow each other without gaps up to the end of the file.
    """
    from safetensors import SafetensorError, safe_open

    buffers: dict[str, NDArray[Any]] = {}
    try:
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
    except (SafetensorError, ValueError) as error:
        reason = printable(str(error), 200)
        raise ClipError(f"not a growth clip, or cut short or damaged ({reason})") from None
    return text, buffers


def write_container(
    text: str, buffers: Mapping[str, NDArray[Any]], path: Path, force: bool = True
) -> None:
    """Write a file as `atomic_file` does. Raises ClipError if it can't be written."""
    from safetensors import SafetensorError
    from safetensors.numpy import save_file

    try:
        with atomic_file(path, force) as part:
            save_file(dict(buffers), part, {KEY: text})
    except UserError as error:
        raise ClipError(str(error)) from None
    except SafetensorError as error:
        reason = re.sub(r".*I/O error: (.*) \(os error \d+\)", r"\1", str(error))
        raise ClipError(f"{path} can't be written: {reason}.") from None
