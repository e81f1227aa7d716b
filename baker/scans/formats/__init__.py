"""The formats of scans: one module each, behind one registry.

To add a format, write a module here with a function ``read(path: Path) -> Columns``, which raises
`FormatError` where a file is not sound, and name it in `READERS`. Files in any of the formats may
be gzipped.
"""

import gzip
import math
import shutil
import warnings
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from numpy.typing import NDArray

from baker.errors import InputError, asking
from baker.scans.child_process import ChildEnded, ChildProcess

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

NATIVE = {"las", "e57", "mesh"}  # modules whose libraries a damaged file can bring down

KNOWN = f"{', '.join(READERS)}, and any of these gzipped (.ply.gz)"
GZIP = ".gz"
BYTES_A_BYTE = 100  # that a file may unpack to, or native code may take to read it,
UNPACKED_BYTES, NATIVE_BYTES = 64 << 20, 1 << 30  # and how many more


@dataclass(frozen=True)
class Columns:
    """All fields of one file, as they stand in it.

    values:  field name as written in the file -> (N,) numbers of any dtype, all the same length;
             or words, where it may be that of labels.
    notes:   what the reader had to decide, one sentence each.
    """

    values: dict[str, NDArray]
    notes: tuple[str, ...] = ()


class FormatError(Exception):
    """What is wrong with a file, in words that follow its name: "holds no points."

    `line` is where in a text it is wrong, from 1.
    """

    def __init__(self, sentence: str, line: int | None = None) -> None:
        super().__init__(sentence)
        self.line = line

    def about(self, name: object) -> str:
        """The whole sentence about the file of that name."""
        place = "" if self.line is None else f", line {self.line}:"
        return f"'{name}'{place} {self}"


def require_room(count: int, size: float, room: int) -> None:
    """FormatError unless `room` bytes can hold `count` points of at least `size` bytes each.

    To be called before memory is made for as many points as a header announces.
    """
    if count <= 0:
        raise FormatError("holds no points.")
    if count * size > room:
        raise FormatError(
            f"is cut short, or its header is wrong: it announces {count} points "
            f"(at least {math.ceil(count * size)} bytes), but {max(room, 0)} bytes follow."
        )


def require_count(announced: int, found: int, what: str = "points") -> None:
    """FormatError unless as many points (or lines) were found as a header announces."""
    if found != announced:
        sizes = f"it announces {announced} {what}, but {found} follow"
        raise FormatError(f"is cut short, or its header is wrong: {sizes}.")


def require_modest(path: Path, size: int) -> None:
    """FormatError where a compressed file would be unpacked to so many bytes that it is a trap."""
    if size > UNPACKED_BYTES + BYTES_A_BYTE * path.stat().st_size:
        raise FormatError(f"unpacks to more than {BYTES_A_BYTE} times its size, as no scan does.")


def suffix_of(path: Path) -> str:
    """The suffix that tells the format, in lower case and without that of gzip."""
    suffix = path.suffix.lower()
    return Path(path.stem).suffix.lower() if suffix == GZIP else suffix


def require_known(path: Path) -> None:
    """InputError, with the known suffixes, unless the suffix of `path` (any case) is known."""
    if path.suffix == ".gclip":
        raise InputError(f"'{path}' is a clip already; give the scans, or: play {path}.")
    if suffix_of(path) not in READERS:
        what = f"has the unknown suffix '{path.suffix}'" if path.suffix else "has no suffix"
        raise InputError(f"'{path}' {what}; known are {KNOWN}.")


def read_columns(
    path: Path, names: Sequence[str] = (), child: ChildProcess | None = None
) -> Columns:
    """All fields of a scan; the suffix of `path` tells the format.

    names: of the columns of a text table. child: where native code reads, which a damaged file may
    bring down; by default in this process. Raises InputError: an unknown suffix, or a file that
    can't be opened or is not sound.
    """
    require_known(path)
    kind = suffix_of(path)
    reader = READERS[kind]
    if names and reader != "text":
        raise InputError(f"'{path}' is no text table: leave out --columns.")
    try:
        with asking(path):
            with path.open("rb") as file:  # libraries say little of folders and forbidden files
                if not file.read(1):
                    raise FormatError("is an empty file.")
            with _unpacked(path) as plain:
                arguments: tuple[Any, ...] = (reader, plain, *([names] if names else []))
                memory = NATIVE_BYTES + BYTES_A_BYTE * plain.stat().st_size
                apart = child if reader in NATIVE else None
                try:
                    columns: Columns = (
                        apart.call(memory, _read, *arguments) if apart else _read(*arguments)
                    )
                except ChildEnded as error:
                    raise FormatError(_unsound(plain, str(error))) from error
            if not any(map(len, columns.values.values())):
                raise FormatError("holds no points.")
    except FormatError as fault:
        raise InputError(fault.about(path)) from fault
    return columns


def _read(reader: str, path: Path, *names: Sequence[str]) -> Columns:
    """By the module of that name, whatever its libraries raise where a file is not sound."""
    try:
        with warnings.catch_warnings(action="ignore"):
            columns: Columns = import_module(f"{__name__}.{reader}").read(path, *names)
            return columns
    except (FormatError, OSError, ImportError, MemoryError, KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic of the LAZ decoder is no Exception
        reason = " ".join((str(error) or type(error).__name__).split())[:120]
        raise FormatError(_unsound(path, reason)) from error


def _unsound(path: Path, reason: str) -> str:
    return f"is no sound {path.suffix[1:].upper()} file, or is cut short ({reason})."


@contextmanager
def _unpacked(path: Path) -> Iterator[Path]:
    """The file itself, or where it is gzipped one with its content for as long as it is read."""
    if path.suffix.lower() != GZIP:
        yield path
        return
    with TemporaryDirectory(prefix="bake-") as folder:
        plain = Path(folder, f"scan{suffix_of(path)}")
        try:
            with gzip.open(path) as packed, plain.open("wb") as file:
                while chunk := packed.read(shutil.COPY_BUFSIZE):  # type: ignore[attr-defined]
                    require_modest(path, file.tell() + file.write(chunk))
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise FormatError(f"is no sound gzip file, or is cut short ({error}).") from error
        if plain.stat().st_size == 0:
            raise FormatError("holds an empty file.")
        yield plain
