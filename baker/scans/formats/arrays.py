"""Read NumPy arrays (NPY, NPZ) in the layouts of docs/scans.md. No objects are unpickled."""

import zipfile
from collections.abc import Container
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import excerpt
from baker.scans.formats import Columns, FormatError, require_no_bomb, require_room
from baker.scans.formats.text import USUAL_WIDTHS, usual_names

POINTS = ("points", "positions", "xyz")
COLORS = ("colors", "colours", "rgb")
NUMBERS = "biuf"  # dtype kinds


def read(path: Path) -> Columns:
    """Read the columns of a table (NPY), or the arrays of an archive (NPZ)."""
    if path.suffix.lower() == ".npz":
        _require_valid_headers(path)
        with np.load(path, allow_pickle=False) as file:
            return Columns(_columns_of(dict(file)))
    # A memory map allocates nothing for values that a damaged header only announces.
    array = np.load(path, mmap_mode="r", allow_pickle=False)
    if array.dtype.names:
        return Columns({n: np.asarray(array[n]) for n in array.dtype.names if _is_column(array[n])})
    table = np.asarray(_table("an array", array, USUAL_WIDTHS))
    names = usual_names(table)
    names += [f"column {i + 1}" for i in range(len(names), table.shape[1])]
    columns = dict(zip(names, table.T, strict=True))
    return Columns(columns, (f"columns taken as {' '.join(names)}.",))


def _columns_of(arrays: dict[str, NDArray]) -> dict[str, NDArray]:
    """The columns of an archive of named arrays."""
    points = next((name for name in POINTS if name in arrays), None)
    if points is None:
        listed = excerpt(", ".join(arrays)) or "none"
        raise FormatError(f"has no array '{POINTS[0]}' (it has {listed}).")
    columns = dict(zip("xyz", _table(f"'{points}'", arrays.pop(points), (3,)).T, strict=True))
    for name, values in arrays.items():
        if name in COLORS:
            channels = _table(f"'{name}'", values, (3, 4)).T
            columns |= dict(zip(("red", "green", "blue"), channels, strict=False))
        elif _is_column(values):
            columns["label" if name == "labels" else name] = values
    count = len(columns["x"])
    if wrong := [name for name, values in columns.items() if len(values) != count]:
        differing = f"{len(columns[wrong[0]])} values in its array '{excerpt(wrong[0])}'"
        raise FormatError(f"has {count} points, but {differing}.")
    return columns


def _is_column(values: NDArray) -> bool:
    return values.ndim == 1 and values.dtype.kind in NUMBERS


def _table(name: str, values: NDArray, widths: Container[int]) -> NDArray:
    """The values of an array; raises FormatError if they are not numbers in so many columns."""
    if values.ndim != 2 or values.shape[1] not in widths or values.dtype.kind not in NUMBERS:
        description = f"of shape {values.shape} and type {values.dtype}"
        raise FormatError(f"has {name} {description}, not (N, 3) numbers (docs/scans.md).")
    return values


def _require_valid_headers(path: Path) -> None:
    """Refuse arrays that announce more than the archive holds, before NumPy allocates them."""
    with zipfile.ZipFile(path) as archive:
        require_no_bomb(path, sum(member.file_size for member in archive.infolist()))
        for member in archive.infolist():
            with archive.open(member) as file:
                version = np.lib.format.read_magic(file)
                read_header = getattr(np.lib.format, "read_array_header_{}_{}".format(*version))
                shape, _, dtype = read_header(file)
                require_room(int(np.prod(shape, dtype=object)), dtype.itemsize, member.file_size)
