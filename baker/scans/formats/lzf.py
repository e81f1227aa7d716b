"""Decompression of LZF, which compressed PCD files use."""

from __future__ import annotations


def decompress(packed: bytes, size: int) -> bytes:
    """Unpack LZF data to `size` bytes; ValueError or IndexError where they are damaged.

    A control byte below 32 announces a run of literal bytes; any other one a copy of earlier
    output, by its length and its distance. Format: Marc Lehmann, liblzf.
    """
    result, place = bytearray(), 0
    while place < len(packed) and len(result) <= size:
        control, place = packed[place], place + 1
        if control < 32:
            run: bytes | bytearray = packed[place : place + control + 1]
            place += control + 1
        else:
            length = (control >> 5) + 2
            if length == 9:
                length, place = length + packed[place], place + 1
            start, place = len(result) - ((control & 31) << 8) - packed[place] - 1, place + 1
            if start < 0:
                raise ValueError("an LZF reference points before the data")
            run = result[start : start + length]
            run *= -(-length // len(run))  # a copy may overlap its own output: a repeated pattern
            run = run[:length]
        result += run
    if len(result) != size or place != len(packed):
        raise ValueError("LZF data of another size")
    return bytes(result)
