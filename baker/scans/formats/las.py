"""LAS and LAZ, by laspy (LAZ with its lazrs backend)."""

import struct
from pathlib import Path

import numpy as np

from baker.scans.formats import Columns, FormatError, require_count, require_room

BYTES_AT_A_TIME = 32 << 20  # bytes of points that are decoded at a time
MIN_HEADER_BYTES = 227  # bytes, LAS 1.0 to 1.2
MIN_RECORD_BYTES = 54  # bytes of a variable length record without content


def read(path: Path) -> Columns:
    """x, y, z as scaled float64, and all other dimensions under laspy's names.

    Raises FormatError where laspy can't read the file, or it ends before its points do.
    """
    import laspy

    _check_beginning(path)
    with laspy.open(path, read_evlrs=False) as file:
        header, form = file.header, file.header.point_format
        if not header.scales.all():
            raise FormatError("has a LAS header with the scale 0, which puts all points into one.")
        room = path.stat().st_size - header.offset_to_point_data
        require_room(header.point_count, 0 if header.are_points_compressed else form.size, room)
        # In chunks, so that memory is made only for points that are there.
        chunks = list(file.chunk_iterator(max(1, BYTES_AT_A_TIME // form.size)))
        require_count(header.point_count, sum(map(len, chunks)))
        names = ["x", "y", "z", *(name for name in form.dimension_names if name not in [*"XYZ"])]
        with np.errstate(all="ignore"):  # a senseless scale gives points that aren't finite
            columns = {
                name: np.concatenate([np.asarray(chunk[name]) for chunk in chunks])
                for name in names
            }
    colors = {"red", "green", "blue"}  # often only room for them, that nobody filled in
    unused = set() if any(columns[name].any() for name in colors & set(columns)) else colors
    unused |= {name for name, values in columns.items() if values.ndim > 1}
    return Columns({name: values for name, values in columns.items() if name not in unused})


def _check_beginning(path: Path) -> None:
    """Refuse what laspy would take minutes over: records by the million that can't be there."""
    with path.open("rb") as file:
        start = file.read(MIN_HEADER_BYTES)
    if len(start) < MIN_HEADER_BYTES or not start.startswith(b"LASF"):
        raise FormatError("is not a LAS file: it doesn't begin with 'LASF'.")
    header_size, points_offset, records = struct.unpack_from("<HII", start, 94)
    size = path.stat().st_size
    if (
        max(header_size, points_offset) > size
        or records * MIN_RECORD_BYTES > points_offset - header_size
    ):
        raise FormatError(
            f"is no sound LAS file, or is cut short (of its {size} bytes its header says that "
            f"{records} records lie between bytes {header_size} and {points_offset})."
        )
