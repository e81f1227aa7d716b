"""Streams a clip's points to the GPU in chunks, and evicts chunks that no longer fit.

The points of a group are ordered so that every prefix is a representative sample (docs/format.md).
A group is cut into chunks in this order, and chunks are filled slice by slice. Therefore the points
on the GPU always show the whole plant, if with fewer points.
"""

import mmap
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice

import moderngl
import numpy as np

from gclip import Clip, Group, Interval
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

STEP = 4096  # pages read between checks whether the interval is still wanted


class Prefetch:
    """Reads one interval at a time into memory.

    A clip is memory-mapped, so its pages are read from disk when they are first touched. Touching
    them here keeps the upload from waiting for the disk.
    """

    def __init__(self) -> None:
        self._executor = ThreadPoolExecutor(1)
        self._wanted: int | None = None
        self._reading: Future[None]

    def has_read(self, index: int, interval: Interval) -> bool:
        """Whether an interval is in memory; the first call begins to read it, and no other one."""
        if index != self._wanted:
            self._wanted = index
            self._reading = self._executor.submit(self._read, index, interval)
        return self._reading.done()

    def stop(self) -> None:
        self._wanted = None
        self._executor.shutdown(cancel_futures=True)

    def _read(self, index: int, interval: Interval) -> None:
        """Raises ClipError for a truncated file, as uploading it does, which reports that."""
        for buffer in buffers_of(interval):
            pages = buffer.reshape(-1).view(np.uint8)[:: mmap.PAGESIZE]
            for first in range(0, len(pages), STEP):
                if self._wanted != index:
                    return
                check_not_truncated(buffer)
                pages[first : first + STEP].max(initial=0)


class ChunkStore:
    """The chunks on the GPU.

    room:   bytes for all chunks together; a single chunk is kept whatever its size.
    size:   bytes that the chunks occupy.
    loaded: bytes uploaded so far.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, room: int) -> None:
        self._context = context
        self._clip = clip
        self._room = room
        self._kept: dict[Chunk, ChunkBuffers] = {}  # least recently used first
        self._bytes: Counter[int] = Counter()  # by interval
        self._prefetch = Prefetch()
        self._wanted: list[tuple[int, Group, int]] = []
        self._plan: list[tuple[Chunk, int]] = []  # what remains to be uploaded, the last one first
        self.size = 0
        self.loaded = 0

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
        groups = [(drawn.layer.interval, drawn.layer.group, drawn.count) for drawn in wanted]
        shown = max((index for index, *_ in groups), default=0)
        if groups != self._wanted:
            following = [
                DrawRange(Layer(shown + 1, group, 0, 0, 1), group.count)
                for interval in self._clip.intervals[shown + 1 : shown + 2]
                for group in interval.groups
            ]
            self._plan = [*self._slices(wanted), *self._slices(following)][::-1]
            for drawn in wanted:
                for chunk, count in islice(self.chunks(drawn), 1):
                    self.fetch(chunk, min(count, SLICE))
            self._wanted = groups
        while self._plan and time.perf_counter() < ends:
            chunk, count = self._plan[-1]
            ahead = chunk.interval > shown
            if ahead and not self._prefetch.has_read(
                chunk.interval, self._clip.intervals[chunk.interval]
            ):
                break
            self._plan.pop()
            if chunk in self._kept or self._fits(chunk, ahead):
                self.loaded += self._made(chunk).upload(count)
        return [self.resident(drawn) for drawn in wanted]

    def _slices(self, ranges: list[DrawRange]) -> list[tuple[Chunk, int]]:
        """Chunks and the number of points to fill each to, in an order of which every prefix holds
        about the same share of every range.
        """
        placed = [
            ((chunk.first - drawn.layer.group.first + upto) / drawn.count, chunk, min(upto, count))
            for drawn in ranges
            for chunk, count in self.chunks(drawn)
            for upto in range(SLICE, count + SLICE, SLICE)
        ]
        return [(chunk, upto) for _, chunk, upto in sorted(placed, key=lambda p: p[0])]

    def _fits(self, chunk: Chunk, ahead: bool) -> bool:
        """Whether a chunk fits: ahead of time without evicting any, else beside its interval's."""
        needed = bytes_per_point(self._clip.intervals[chunk.interval]) * chunk.count
        return needed + (self.size if ahead else self._bytes[chunk.interval]) <= self._room

    def _made(self, chunk: Chunk) -> ChunkBuffers:
        """A chunk's buffers, marked as the most recently used."""
        buffers = self._kept.pop(chunk, None)
        if buffers is None:
            needed = bytes_per_point(self._clip.intervals[chunk.interval]) * chunk.count
            while self._kept and self.size + needed > self._room:
                self._drop(self._least_wanted(chunk.interval))
            buffers = self._allocated(chunk)
            self.size += buffers.size
            self._bytes[chunk.interval] += buffers.size
        self._kept[chunk] = buffers
        return buffers

    def _allocated(self, chunk: Chunk) -> ChunkBuffers:
        """Allocate buffers; where the GPU has less memory than reported, evict chunks first."""
        while True:
            self._context.gc()
            try:
                return ChunkBuffers(self._context, self._clip.intervals[chunk.interval], chunk)
            except OutOfGpuMemory:
                if not self._kept:
                    raise
                self._room = self.size // 2
                while self._kept and self.size > self._room:
                    self._drop(self._least_wanted(chunk.interval))

    def _least_wanted(self, shown: int) -> Chunk:
        """The least recently used chunk of other intervals, else the most recently used one of the
        interval that is shown: an interval larger than the memory keeps its first chunks.
        """
        other = next((chunk for chunk in self._kept if chunk.interval != shown), None)
        return other or next(reversed(self._kept))

    def _drop(self, chunk: Chunk) -> None:
        buffers = self._kept.pop(chunk)
        self.size -= buffers.size
        self._bytes[chunk.interval] -= buffers.size
        self._wanted = []  # the plan may need it again

    def stop(self) -> None:
        """Stop reading ahead."""
        self._prefetch.stop()
