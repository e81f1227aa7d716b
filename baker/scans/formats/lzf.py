"""Decompression of LZF, which compressed PCD files use."""

from __future__ import annotations


def decompress(packed: bytes, size: int) -> bytes:
    """Unpack LZF data to `size` bytes; ValueError where they are damaged or of another size.

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
            length = control >> 5
            needed = packed[place : place + (2 if length == 7 else 1)]
            if len(needed) < (2 if length == 7 else 1):
                raise ValueError("LZF data end within a reference")
            place += len(needed)
            length += 2 + (needed[0] if length == 7 else 0)
            start = len(result) - ((control & 31) << 8) - needed[-1] - 1
            if start < 0:
                raise ValueError("an LZF reference points before the data")
            run = result[start : start + length]
            run *= -(-length // len(run))  # a copy may overlap its own output: a repeated pattern
            run = run[:length]
        result += run
    if len(result) != size or place != len(packed):
        raise ValueError("LZF data of another size")
    return bytes(result)
