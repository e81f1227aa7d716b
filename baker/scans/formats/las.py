"""Read LAS and LAZ with laspy (LAZ with its lazrs backend)."""

import struct
from pathlib import Path

import numpy as np

from baker.scans.formats import Columns, FormatError, require_count, require_room

CHUNK_BYTES = 32 << 20  # of points that are decoded at a time
MIN_RECORD_BYTES = 54  # of a variable length record without content


def read(path: Path) -> Columns:
    """Read x, y, z as scaled float64, and all other dimensions by their names in laspy."""
    import laspy

    _require_valid_header(path)
    with laspy.open(path, read_evlrs=False) as file:
        header, form = file.header, file.header.point_format
        if not header.scales.all():
            raise FormatError("has a LAS header with the scale 0, which puts all points into one.")
        room = path.stat().st_size - header.offset_to_point_data
        require_room(header.point_count, 0 if header.are_points_compressed else form.size, room)
        # In chunks, so that no memory is allocated for points that are only announced.
        chunks = list(file.chunk_iterator(max(1, CHUNK_BYTES // form.size)))
        require_count(header.point_count, sum(map(len, chunks)))
        names = ["x", "y", "z", *(name for name in form.dimension_names if name not in [*"XYZ"])]
        columns = {n: np.concatenate([np.asarray(chunk[n]) for chunk in chunks]) for n in names}
    colors = {"red", "green", "blue"}  # are all 0 in many files, where no colours were measured
    unused = set() if any(columns[name].any() for name in colors & set(columns)) else colors
    unused |= {name for name, values in columns.items() if values.ndim > 1}
    return Columns({name: values for name, values in columns.items() if name not in unused})


def _require_valid_header(path: Path) -> None:
    """Raise FormatError for records that can't be in the file; laspy spends minutes on them."""
    with path.open("rb") as file:
        header_size, points_offset, records = struct.unpack("<HII", file.read(104)[94:])
    if not header_size + records * MIN_RECORD_BYTES <= points_offset <= path.stat().st_size:
        content = f"announces {records} records between bytes {header_size} and {points_offset}"
        raise FormatError(f"is not a valid LAS file, or is cut short (its header {content}).")
