"""A clip's points on the GPU, chunk by chunk: what is seen comes, what no longer fits goes.

Points of a group lie in an order of which every prefix is a fair sample (docs/format.md). So a
group is cut into chunks from its beginning, each filled slice by slice, and what is on the GPU
already, or what there is time to draw, is the whole plant with fewer points.
"""

import time
from collections import Counter
from collections.abc import Iterator
from itertools import islice

import moderngl

from gclip import Clip
from gclip.evaluate import Layer
from player.gl.gl_errors import OutOfGpuMemory
from player.rendering.point_buffers import (
    SLICE,
    Chunk,
    ChunkBuffers,
    DrawRange,
    bytes_per_point,
    chunk_length,
)
from player.rendering.prefetch import Prefetch


class ChunkStore:
    """The chunks on the GPU.

    room: bytes that they may take up there together; one chunk is kept whatever its size.

    Attributes
    ----------
    size : int
        Bytes that they take up now.
    loaded : int
        Bytes brought there so far.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, room: int) -> None:
        self._context = context
        self._clip = clip
        self._room = room
        self._kept: dict[Chunk, ChunkBuffers] = {}  # the longest unused first
        self._bytes: Counter[int] = Counter()  # of those of each interval
        self._prefetch = Prefetch()
        self._wanted: list[DrawRange] = []
        self._plan: Iterator[tuple[Chunk, int]] = iter(())  # what of it is still to come
        self._ahead: tuple[int, Iterator[tuple[Chunk, int]]] = (-1, iter(()))
        self.size = 0
        self.loaded = 0

    def chunks(self, drawn: DrawRange) -> Iterator[tuple[Chunk, int]]:
        """A range's chunks, and how many points of each are drawn."""
        group, length = drawn.layer.group, chunk_length(self._clip.intervals[drawn.layer.interval])
        for offset in range(0, drawn.count, length):
            count = min(length, group.count - offset)
            chunk = Chunk(drawn.layer.interval, group.first + offset, count)
            yield chunk, min(count, drawn.count - offset)

    def resident(self, drawn: DrawRange) -> int:
        """How many of a range's points are there, from the first on."""
        there = 0
        for chunk, count in self.chunks(drawn):
            found = min(self._kept[chunk].resident, count) if chunk in self._kept else 0
            there += found
            if found < count:
                break
        return there

    def fetch(self, chunk: Chunk, count: int) -> ChunkBuffers:
        """A chunk's buffers with `count` points, uploaded if they are not there yet; valid until
        the next one's.
        """
        buffers = self._made(chunk)
        while buffers.resident < count:
            self.loaded += buffers.upload(count)
        return buffers

    def load(self, wanted: list[DrawRange], seconds: float) -> list[int]:
        """Upload what is wanted for some seconds, fair samples first; then, as far as there is
        time and room, the interval after. Gives how many points of each range are there: at least
        those of its first slice. What is there already costs nothing to find.
        """
        ends = time.perf_counter() + seconds
        groups = [(drawn.layer.interval, drawn.layer.group, drawn.count) for drawn in wanted]
        if groups != [(d.layer.interval, d.layer.group, d.count) for d in self._wanted]:
            self._plan = self._slices(wanted)
            for drawn in wanted:
                for chunk, count in islice(self.chunks(drawn), 1):
                    self.fetch(chunk, min(count, SLICE))
            self._wanted = wanted
        if self._follow(self._plan, ends):
            self._load_ahead(max((d.layer.interval for d in wanted), default=-1) + 1, ends)
        return [self.resident(drawn) for drawn in wanted]

    def _follow(self, plan: Iterator[tuple[Chunk, int]], ends: float, ahead: bool = False) -> bool:
        """Upload slices until there is no time, or no room; whether the plan is done."""
        while time.perf_counter() < ends:
            chunk, count = next(plan, (None, 0))
            if chunk is None:
                return True
            if chunk in self._kept or self._fits(chunk, ahead):
                self.loaded += self._made(chunk).upload(count)
        return False

    def _load_ahead(self, index: int, ends: float) -> None:
        if index >= len(self._clip.intervals):
            return
        interval = self._clip.intervals[index]
        self._prefetch.start(index, interval)
        if self._ahead[0] != index:
            layers = [Layer(index, group, 0, 0, 1) for group in interval.groups]
            ranges = [DrawRange(layer, layer.group.count) for layer in layers]
            self._ahead = (index, self._slices(ranges))
        if self._prefetch.done(index):
            self._follow(self._ahead[1], ends, ahead=True)

    def _slices(self, ranges: list[DrawRange]) -> Iterator[tuple[Chunk, int]]:
        """Chunks, and up to where each is to be filled, so that each prefix of all this holds about
        the same share of every range.
        """
        placed = [
            ((offset + upto) / drawn.count, chunk, min(upto, count))
            for drawn in ranges
            for offset, (chunk, count) in _with_offsets(self.chunks(drawn))
            for upto in range(SLICE, count + SLICE, SLICE)
        ]
        return iter([(chunk, upto) for _, chunk, upto in sorted(placed, key=lambda p: p[0])])

    def _fits(self, chunk: Chunk, ahead: bool) -> bool:
        """Whether a chunk finds room: ahead without dropping any, else any of its interval."""
        needed = bytes_per_point(self._clip.intervals[chunk.interval]) * chunk.count
        return needed + (self.size if ahead else self._bytes[chunk.interval]) <= self._room

    def _made(self, chunk: Chunk) -> ChunkBuffers:
        """A chunk's buffers, the last to be dropped from now on."""
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
        """On a GPU that is full sooner than it said, the others make room, and less is kept."""
        while True:
            try:
                return ChunkBuffers(self._context, self._clip.intervals[chunk.interval], chunk)
            except OutOfGpuMemory:
                if not self._kept:
                    raise
                self._room = self.size // 2
                while self._kept and self.size > self._room:
                    self._drop(self._least_wanted(chunk.interval))

    def _least_wanted(self, shown: int) -> Chunk:
        """Of other intervals the longest unused; of the shown one the last used, so that going
        over a too large interval again and again finds its beginning in place.
        """
        other = next((chunk for chunk in self._kept if chunk.interval != shown), None)
        return other or next(reversed(self._kept))

    def _drop(self, chunk: Chunk) -> None:
        buffers = self._kept.pop(chunk)
        self.size -= buffers.size
        self._bytes[chunk.interval] -= buffers.size
        self._wanted, self._ahead = [], (-1, iter(()))  # they may have to come again
        buffers.release()

    def release(self) -> None:
        self._prefetch.stop()
        for chunk in list(self._kept):
            self._drop(chunk)


def _with_offsets(chunks: Iterator[tuple[Chunk, int]]) -> Iterator[tuple[int, tuple[Chunk, int]]]:
    """Each chunk with the number of points before it."""
    before = 0
    for chunk, count in chunks:
        yield before, (chunk, count)
        before += count
