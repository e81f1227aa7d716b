"""LAS and LAZ, by laspy (LAZ with its lazrs backend).

The decoder of LAZ makes room for whatever sizes the file announces, and ends the whole process
where there is none: chunks are checked before. Format: the LAZ 1.4 specification, rapidlasso.
"""

import struct
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from baker.scans.cloud import Columns
from baker.scans.formats import FormatError, require_count, require_room

BYTES_AT_A_TIME = 32 << 20  # bytes of points that are decoded at a time
MIN_HEADER_BYTES = 227  # bytes, LAS 1.0 to 1.2
MIN_RECORD_BYTES = 54  # bytes of a variable length record without content
VARIABLE_SIZE = 2**32 - 1  # chunks tell their own sizes
MAX_CHUNK_BYTES = 1 << 30  # bytes of points; usual are 50,000 points
LAYERED = 3  # the compressor that writes each field of a chunk as a layer of its own
LAYERS = {10: 9, 11: 1, 12: 2, 13: 1}
"""Layers of each kind of item: point, RGB, RGB and near infrared, wave packet; other items have
one for each byte."""


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
        if header.are_points_compressed:
            _require_sound_chunks(path, header)
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


def _require_sound_chunks(path: Path, header: Any) -> None:
    """FormatError unless the sizes that a compressed file tells of its chunks fit into it."""
    import lazrs  # type: ignore[import-untyped, unused-ignore]

    record = header.vlrs.get("LasZipVlr")[0].record_data
    vlr = lazrs.LazVlr(record)
    begin, size, whole = header.offset_to_point_data, header.point_format.size, path.stat().st_size
    with path.open("rb") as file:
        table = _number(file, "<q", begin)
        if table == -1:  # written in one go: its place is told at the end
            table = _number(file, "<q", whole - 8)
        count = _number(file, "<I", table + 4) if begin + 8 <= table <= whole - 8 else 0
        is_sound = vlr.item_size() == size and count * size <= whole - begin and count > 0
        (chunk_size,) = struct.unpack_from("<I", record, 12)  # points, for which room is made
        is_sound &= chunk_size == VARIABLE_SIZE or chunk_size * size <= MAX_CHUNK_BYTES
        if is_sound:
            file.seek(begin)
            chunks = [length for _, length in lazrs.read_chunk_table(file, vlr)]
            is_sound = sum(chunks) <= table - begin - 8
        if is_sound and struct.unpack_from("<H", record)[0] == LAYERED:
            items = struct.iter_unpack("<HHH", record[34:])  # kind, size and version of each
            layers = sum(LAYERS.get(kind, item_size) for kind, item_size, _ in items)
            is_sound = _layers_fit(file, begin + 8, chunks, size, layers)
    if not is_sound:
        raise FormatError(
            "is no sound LAZ file, or is cut short: its compressed chunks don't fit into it."
        )


def _layers_fit(file: BinaryIO, start: int, chunks: list[int], size: int, layers: int) -> bool:
    """A chunk is its first point as it is, the count of points, the layers' sizes, the layers."""
    for length in chunks:
        file.seek(start + size + 4)
        sizes = struct.unpack(f"<{layers}I", file.read(4 * layers))
        if size + 4 + 4 * layers + sum(sizes) > length:
            return False
        start += length
    return True


def _number(file: BinaryIO, form: str, place: int) -> int:
    file.seek(max(place, 0))
    return int(struct.unpack(form, file.read(struct.calcsize(form)))[0])
