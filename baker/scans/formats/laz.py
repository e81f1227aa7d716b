"""What a LAZ file says of its compressed chunks, checked before the decoder believes it.

The decoder makes room for whatever sizes it is told, and where there is no room for them it ends
the whole process. Format: the LAZ 1.4 specification, rapidlasso (https://laszip.org).
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any, BinaryIO

from baker.scans.formats.faults import FormatError

LAYERED = 3  # the compressor that writes each field of a chunk as a layer of its own
LAYERS = {10: 9, 11: 1, 12: 2, 13: 1}
"""Layers of each kind of item: point, RGB, RGB and near infrared, wave packet; other items have
one for each byte."""


def require_sound_chunks(path: Path, header: Any) -> None:
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
