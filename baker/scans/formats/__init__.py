"""Readers of scan files: one module for each format, listed in `READERS`.

Each has a function ``read(path: Path) -> Columns`` that raises `FormatError` for a damaged file. A
file in any format may be gzipped.
"""

import gzip
import shutil
import warnings
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from tempfile import gettempdir

from numpy.typing import NDArray

from baker.errors import InputError, input_errors
from baker.scans.child_process import ChildProcess
from gclip.terminal.atomic import folder_beside

READERS = {
    ".ply": "ply",
    ".pcd": "pcd",
    **dict.fromkeys((".xyz", ".txt", ".csv", ".asc", ".pts"), "text"),
    **dict.fromkeys((".las", ".laz"), "las"),
    ".e57": "e57",
    **dict.fromkeys((".npy", ".npz"), "arrays"),
    **dict.fromkeys((".obj", ".stl", ".off", ".glb", ".gltf"), "mesh"),
}
"""Suffix in lower case -> module of this package."""

NATIVE = {"las", "e57", "mesh"}  # modules whose libraries may crash on a damaged file

KNOWN = f"{', '.join(READERS)}, and any of these gzipped (.ply.gz)"
# Limits in bytes: a file may unpack to UNPACKED_BYTES plus BYTES_PER_BYTE times its size, and
# native code may use NATIVE_BYTES plus BYTES_PER_BYTE times its size of memory.
BYTES_PER_BYTE = 100
UNPACKED_BYTES, NATIVE_BYTES = 64 << 20, 1 << 30


@dataclass(frozen=True)
class Columns:
    """All fields of one file, unchanged."""

    values: dict[str, NDArray]  # by name in the file: (N,) numbers, or words that may be labels
    notes: tuple[str, ...] = ()  # sentences on the reader's decisions


class FormatError(Exception):
    """A file can't be read. Its arguments are a sentence, which follows the file's name ("holds no
    points."), and, for text files, the number of the wrong line, from 1.
    """


def require_room(count: int, size: float, room: int) -> None:
    """Raise FormatError unless `room` bytes can hold `count` points of at least `size` bytes each.

    Call it before memory is allocated for the points that a header announces.
    """
    if count <= 0:
        raise FormatError("holds no points.")
    if count * size > room:
        announced = f"it announces {count} points, but {max(room, 0)} bytes follow"
        raise FormatError(f"is cut short, or its header is wrong: {announced}.")


def require_count(announced: int, actual: int, what: str = "points") -> None:
    """Raise FormatError unless the `actual` number of points (or lines) is the announced one."""
    if actual != announced:
        sizes = f"it announces {announced} {what}, but {actual} follow"
        raise FormatError(f"is cut short, or its header is wrong: {sizes}.")


def require_no_bomb(path: Path, size: int) -> None:
    """Raise FormatError if a compressed file unpacks to more bytes than a scan of its size can."""
    if size > UNPACKED_BYTES + BYTES_PER_BYTE * path.stat().st_size:
        raise FormatError(f"unpacks to more than {BYTES_PER_BYTE} times its size, as no scan does.")


def suffix_of(path: Path) -> str:
    """The suffix that names the format of a file, in lower case: ".ply" of "a.PLY.gz"."""
    suffix = path.suffix.lower()
    return Path(path.stem).suffix.lower() if suffix == ".gz" else suffix


def require_known(path: Path) -> None:
    """Raise InputError, with the known suffixes, unless the suffix of `path` is one of them."""
    if path.suffix == ".gclip":
        raise InputError(f"'{path}' is a clip already; give the scans, or: play {path}.")
    if suffix_of(path) not in READERS:
        what = f"has the unknown suffix '{path.suffix}'" if path.suffix else "has no suffix"
        raise InputError(f"'{path}' {what}; known are {KNOWN}.")


def read_columns(
    path: Path, names: Sequence[str] = (), child: ChildProcess | None = None
) -> Columns:
    """Read all fields of a scan from a file, in the format that its suffix names.

    names: of the columns of a text table, instead of its header. child: the process in which native
    readers run, by default this one. Raises InputError if the suffix is unknown, or the file can't
    be opened or is damaged.
    """
    require_known(path)
    reader = READERS[suffix_of(path)]
    if names and reader != "text":
        raise InputError(f"'{path}' is no text table: leave out --columns.")
    try:
        with input_errors(path), _unpacked(path) as unpacked:
            # The libraries' own messages don't name the reason why a file can't be opened.
            with unpacked.open("rb") as file:
                if not file.read(1):
                    raise FormatError("is an empty file.")
            columns = _read(reader, unpacked, names, child if reader in NATIVE else None)
        if not any(map(len, columns.values.values())):
            raise FormatError("holds no points.")
    except FormatError as fault:
        sentence, *line = fault.args
        line_of_file = f", line {line[0]}:" if line else ""
        raise InputError(f"'{path}'{line_of_file} {sentence}") from fault
    return columns


def _read(reader: str, path: Path, names: Sequence[str], child: ChildProcess | None) -> Columns:
    """Read by the module `reader`; any exception of its libraries becomes a FormatError."""
    try:
        with warnings.catch_warnings(action="ignore"):
            if child:
                memory = NATIVE_BYTES + BYTES_PER_BYTE * path.stat().st_size
                return child.call(memory, _read, reader, path, names, None)
            return import_module(f"{__name__}.{reader}").read(path, *filter(None, [names]))
    except (FormatError, OSError, ImportError, MemoryError, KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic of the LAZ decoder is not an Exception
        reason = " ".join((str(error) or type(error).__name__).split())[:120]
        sentence = f"is not a valid {path.suffix[1:].upper()} file, or is cut short ({reason})."
        raise FormatError(sentence) from error


@contextmanager
def _unpacked(path: Path) -> Iterator[Path]:
    """The file itself or, if it is gzipped, a temporary file with its content."""
    if path.suffix.lower() != ".gz":
        yield path
        return
    with folder_beside(Path(gettempdir(), "bake")) as folder:
        plain = folder / f"scan{suffix_of(path)}"
        try:
            with gzip.open(path) as packed, plain.open("wb") as file:
                while chunk := packed.read(shutil.COPY_BUFSIZE):  # type: ignore[attr-defined]
                    require_no_bomb(path, file.tell() + file.write(chunk))
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise FormatError(f"is not a valid gzip file, or is cut short ({error}).") from error
        yield plain
