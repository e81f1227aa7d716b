"""LAS and LAZ, by laspy (LAZ with its lazrs backend).

Labels are looked for among the extra dimensions and in `classification`. A classification of 0
means "created, never classified" (LAS specification 1.4, table 17): where it is 0 for all points
of all scans, there are no labels.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.scans.cloud import Columns
from baker.scans.fields import LABEL_NAMES
from baker.scans.formats.faults import FormatError, library_faults, require_count, require_room
from baker.scans.formats.laz import require_sound_chunks

CHUNK = 32 << 20  # bytes of points that are decoded at a time
SHORTEST_HEADER = 227  # bytes, LAS 1.0 to 1.2
SHORTEST_RECORD = 54  # bytes of a variable length record without content


def read(path: Path) -> Columns:
    """x, y, z as scaled float64, and all other dimensions under laspy's names.

    Raises FormatError where laspy can't read the file, or it ends before its points do.
    """
    _check_beginning(path)
    with library_faults("LAS"):
        columns, extra = _read_dimensions(path)
    unused = [["red", "green", "blue"]]  # room for colours that nobody filled in
    if set(extra) & set(LABEL_NAMES):
        unused.append(["classification"])
    for names in unused:
        if set(names) <= set(columns) and not any(columns[name].any() for name in names):
            columns = {name: columns[name] for name in columns if name not in names}
    return Columns(columns)


def _read_dimensions(path: Path) -> tuple[dict[str, NDArray], list[str]]:
    """The (N,) columns by name, and the names of the extra dimensions in lower case."""
    import laspy

    with laspy.open(path, read_evlrs=False) as file:
        header = file.header
        room, size = path.stat().st_size - header.offset_to_point_data, header.point_format.size
        require_room(header.point_count, 0 if header.are_points_compressed else size, room)
        if header.are_points_compressed:
            require_sound_chunks(path, header)
        # In chunks, so that memory is made only for points that are there.
        chunks = list(file.chunk_iterator(max(1, CHUNK // size)))

    require_count(header.point_count, sum(map(len, chunks)))
    names = [name for name in header.point_format.dimension_names if name not in ("X", "Y", "Z")]
    with np.errstate(all="ignore"):  # a senseless scale gives points that aren't finite
        columns = {
            name: np.concatenate([np.asarray(chunk[name]) for chunk in chunks])
            for name in ("x", "y", "z", *names)
        }
    extra = [name.lower() for name in header.point_format.extra_dimension_names]
    return {name: values for name, values in columns.items() if values.ndim == 1}, extra


def _check_beginning(path: Path) -> None:
    """Refuse what laspy would take minutes over: records by the million that can't be there."""
    with path.open("rb") as file:
        start = file.read(SHORTEST_HEADER)
    if len(start) < SHORTEST_HEADER or not start.startswith(b"LASF"):
        raise FormatError("is not a LAS file: it doesn't begin with 'LASF'.")
    header_size, points_offset, record_count = struct.unpack_from("<HII", start, 94)
    size, room = path.stat().st_size, points_offset - header_size
    fault = ""
    if max(header_size, points_offset) > size:
        fault = f"says that the points begin at byte {points_offset}, and the file ends at {size}"
    elif record_count * SHORTEST_RECORD > room:
        records = f"{record_count} records before the points"
        fault = f"announces {records}, for which there are {max(room, 0)} bytes"
    if fault:
        raise FormatError(f"is no sound LAS file, or is cut short (its header {fault}).")
