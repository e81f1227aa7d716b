"""Read NumPy arrays (NPY, NPZ) in the layouts of docs/scans.md. No objects are unpickled."""

import zipfile
from collections.abc import Container, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import excerpt
from baker.scans.formats import Columns, FormatError, require_no_bomb, require_room
from baker.scans.formats.text import USUAL_WIDTHS, usual_names

POINTS = ("points", "positions", "xyz")
COLORS = ("colors", "colours", "rgb")


def read(path: Path) -> Columns:
    """Read the columns of the arrays. Raises FormatError: damaged, or without points."""
    if path.suffix.lower() == ".npz":
        _require_sound_headers(path)
        with np.load(path, allow_pickle=False) as file:
            return Columns(_columns_of(file))
    # A memory map allocates nothing for values that a damaged header only announces.
    array = np.load(path, mmap_mode="r", allow_pickle=False)
    if array.dtype.names:
        return Columns({n: np.asarray(array[n]) for n in array.dtype.names if _is_column(array[n])})
    if not _is_table(array, USUAL_WIDTHS):
        raise FormatError(f"holds {_described(array)}; (N, 3) to (N, 12) numbers are read.")
    names = usual_names(array)
    names += [f"column {i + 1}" for i in range(len(names), array.shape[1])]
    columns = dict(zip(names, np.asarray(array).T, strict=True))
    return Columns(columns, (f"columns taken as {' '.join(names)}.",))


def _columns_of(arrays: Mapping[str, NDArray]) -> dict[str, NDArray]:
    """The columns of an archive of named arrays."""
    points = next((name for name in POINTS if name in arrays), None)
    if points is None:
        found = excerpt(", ".join(arrays)) or "none"
        raise FormatError(f"has no array '{POINTS[0]}' (it has {found}).")
    positions = arrays[points]
    if not _is_table(positions, (3,)):
        raise FormatError(f"has as '{points}' {_described(positions)}, not (N, 3) numbers.")
    columns = dict(zip("xyz", positions.T, strict=True))
    for name in arrays:
        values = arrays[name]
        if name in COLORS and _is_table(values, (3, 4)):
            columns |= dict(zip(("red", "green", "blue"), values.T, strict=False))
        elif name != points and _is_column(values):
            columns["label" if name == "labels" else name] = values
    if wrong := [name for name, values in columns.items() if len(values) != len(positions)]:
        sizes = f"{len(positions)} points, but {len(columns[wrong[0]])} values"
        raise FormatError(f"has {sizes} in its array '{excerpt(wrong[0])}'.")
    return columns


def _described(values: NDArray) -> str:
    return f"an array of shape {values.shape} and type {values.dtype}"


def _is_table(values: NDArray, widths: Container[int]) -> bool:
    return values.ndim == 2 and values.shape[1] in widths and values.dtype.kind in "biuf"


def _is_column(values: NDArray) -> bool:
    return values.ndim == 1 and values.dtype.kind in "biuf"


def _require_sound_headers(path: Path) -> None:
    """Refuse arrays that announce more than the archive holds, before NumPy allocates them."""
    with zipfile.ZipFile(path) as archive:
        require_no_bomb(path, sum(member.file_size for member in archive.infolist()))
        for member in archive.infolist():
            with archive.open(member) as file:
                version = np.lib.format.read_magic(file)
                read_header = getattr(np.lib.format, "read_array_header_{}_{}".format(*version))
                shape, _, dtype = read_header(file)
                require_room(int(np.prod(shape, dtype=object)), dtype.itemsize, member.file_size)
