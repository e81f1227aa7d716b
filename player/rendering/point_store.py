"""Streams a clip's points to the GPU in chunks, and evicts chunks that no longer fit.

The points of a group are ordered so that every prefix is a representative sample (docs/format.md).
A group is cut into chunks in this order, and chunks are filled slice by slice. Therefore the points
on the GPU always show the whole plant, if with fewer points.
"""

import mmap
import time
from collections.abc import Iterator, Set
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice

import moderngl
import numpy as np

from gclip import Clip
from gclip.evaluate import Layer
from gclip.file import check_not_truncated
from player.gl.gl_errors import OutOfGpuMemory
from player.rendering.point_buffers import (
    SLICE,
    Chunk,
    ChunkBuffers,
    DrawRange,
    buffers_of,
    bytes_per_point,
    chunk_length,
)

PAGES = 4096  # read between checks whether the interval is still wanted


class ChunkStore:
    """The chunks on the GPU.

    room:   bytes for all chunks together; a single chunk is kept whatever its size.
    loaded: bytes uploaded so far.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, room: int) -> None:
        self._context = context
        self._clip = clip
        self._room = room
        self._kept: dict[Chunk, ChunkBuffers] = {}  # least recently used first
        self._executor = ThreadPoolExecutor(1)
        self._reading: dict[int, Future[None]] = {}
        self.loaded = 0

    @property
    def size(self) -> int:
        """Bytes that the chunks occupy."""
        return sum(buffers.size for buffers in self._kept.values())

    def chunks(self, drawn: DrawRange) -> Iterator[tuple[Chunk, int]]:
        """The chunks of a range, and how many points of each are drawn."""
        group, length = drawn.layer.group, chunk_length(self._clip.intervals[drawn.layer.interval])
        for offset in range(0, drawn.count, length):
            count = min(length, group.count - offset)
            chunk = Chunk(drawn.layer.interval, group.first + offset, count)
            yield chunk, min(count, drawn.count - offset)

    def resident(self, drawn: DrawRange) -> int:
        """Number of a range's points, from the first on, that are on the GPU."""
        there = 0
        for chunk, count in self.chunks(drawn):
            found = min(self._kept[chunk].resident, count) if chunk in self._kept else 0
            there += found
            if found < count:
                break
        return there

    def fetch(self, chunk: Chunk, count: int) -> ChunkBuffers:
        """A chunk's buffers with at least `count` points uploaded; valid until the next call."""
        buffers = self._made(chunk)
        while buffers.resident < count:
            self.loaded += buffers.upload(count)
        return buffers

    def load(self, wanted: list[DrawRange], seconds: float) -> list[int]:
        """Upload ranges for some seconds, evenly, and then the following interval, as far as time
        and memory allow. Returns for each range the number of points on the GPU, which is at least
        its first slice.
        """
        ends = time.perf_counter() + seconds
        for drawn in wanted:
            for chunk, count in islice(self.chunks(drawn), 1):
                self.fetch(chunk, min(count, SLICE))
        shown = {drawn.layer.interval for drawn in wanted}
        following = max(shown, default=0) + 1
        ahead = [
            DrawRange(Layer(following, group, 0, 0, 1), group.count)
            for interval in self._clip.intervals[following : following + 1]
            for group in interval.groups
        ]
        while time.perf_counter() < ends:
            if not self._upload_slice(wanted, shown) and not (
                ahead and self._has_read(following) and self._upload_slice(ahead)
            ):
                break
        return [self.resident(drawn) for drawn in wanted]

    def _upload_slice(self, ranges: list[DrawRange], keeping: Set[int] | None = None) -> bool:
        """Upload a slice of that range of which the least is there; False if all is there, or no
        more of it fits beside some intervals' chunks, or beside all.
        """
        filled = [drawn for drawn in ranges if drawn.count]
        least = min(filled, key=lambda drawn: self.resident(drawn) / drawn.count, default=None)
        for chunk, count in self.chunks(least) if least else ():
            kept = self._kept.get(chunk)
            if kept is None and not self._fits(chunk, keeping):
                return False
            if kept is None or kept.resident < count:
                self.loaded += self._made(chunk).upload(count)
                return True
        return False

    def _fits(self, chunk: Chunk, keeping: Set[int] | None) -> bool:
        beside = sum(
            buffers.size
            for other, buffers in self._kept.items()
            if keeping is None or other.interval in keeping
        )
        return self._bytes(chunk) + beside <= self._room

    def _bytes(self, chunk: Chunk) -> int:
        return bytes_per_point(self._clip.intervals[chunk.interval]) * chunk.count

    def _made(self, chunk: Chunk) -> ChunkBuffers:
        """A chunk's buffers, marked as the most recently used; evicts others to make room."""
        buffers = self._kept.pop(chunk, None)
        while buffers is None:
            while self._kept and self.size + self._bytes(chunk) > self._room:
                del self._kept[self._least_wanted(chunk.interval)]
            self._context.gc()
            try:
                buffers = ChunkBuffers(self._context, self._clip.intervals[chunk.interval], chunk)
            except OutOfGpuMemory:  # the GPU has less memory than reported
                if not self._kept:
                    raise
                self._room = self.size // 2 + self._bytes(chunk)
        self._kept[chunk] = buffers
        return buffers

    def _least_wanted(self, shown: int) -> Chunk:
        """The least recently used chunk of other intervals, else the most recently used one of the
        interval that is shown: an interval larger than the memory keeps its first chunks.
        """
        other = next((chunk for chunk in self._kept if chunk.interval != shown), None)
        return other or next(reversed(self._kept))

    def _has_read(self, index: int) -> bool:
        """Whether an interval is in memory; the first call begins to read it, and no other one.

        A clip is memory-mapped, so its pages are read from disk when they are first touched.
        Touching them in a thread keeps the upload from waiting for the disk.
        """
        if index not in self._reading:
            self._reading = {index: self._executor.submit(self._read, index)}
        return self._reading[index].done()

    def _read(self, index: int) -> None:
        """Raises ClipError for a truncated file, as uploading it does, which reports that."""
        for buffer in buffers_of(self._clip.intervals[index]):
            pages = buffer.reshape(-1).view(np.uint8)[:: mmap.PAGESIZE]
            for first in range(0, len(pages), PAGES):
                if index in self._reading:
                    check_not_truncated(buffer)
                    pages[first : first + PAGES].max(initial=0)

    def stop(self) -> None:
        """Stop reading ahead."""
        self._reading = {}
        self._executor.shutdown(cancel_futures=True)
