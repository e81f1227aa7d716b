"""A clip's movers on the GPU, chunk by chunk: what is seen comes, what no longer fits goes.

Movers of a group lie in an order of which every prefix is a fair sample (docs/format.md). So a
group is cut into chunks from its beginning, and the chunks that are on the GPU already, or that
there is time to draw, are the whole plant with fewer points.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gclip.evaluate import Layer
from gclip.file import check_whole
from player.gl.gl_errors import OutOfGpuMemory, check_context
from player.rendering.prefetch import Fetcher

if TYPE_CHECKING:
    import moderngl

    from gclip import Clip, Interval

MAX_CHUNK = 1 << 20  # points: within OpenGL's smallest limits (128 MiB, 65,535 workgroups)
PADDING = 48  # bytes: compute shaders read movers by fours


@dataclass(frozen=True)
class Chunk:
    """A run of an interval's movers, all of one group."""

    interval: int
    first: int
    count: int


@dataclass(frozen=True)
class DrawRange:
    """Those of a layer's movers that are to be drawn.

    count: only its first ones: a fair sample, but of whole blocks of neighbours.
    stride: of these, one of so many, or four neighbours of so many fours: the sample has no gaps.
    """

    layer: Layer
    count: int
    stride: int = 1

    @property
    def total(self) -> int:
        """How many points the layer has."""
        return self.layer.group.count

    @property
    def points(self) -> int:
        """How many of them are drawn."""
        return -(-self.count // self.stride)

    def reduced(self, share: float) -> DrawRange:
        """About such a share of its first chunk."""
        stride = max(round(self.stride / share), 1)
        return replace(self, count=min(self.count, MAX_CHUNK), stride=stride)

    def chunks(self) -> Iterator[tuple[Chunk, int]]:
        """Its chunks, and how many movers of each are drawn."""
        group = self.layer.group
        for offset in range(0, self.count, MAX_CHUNK):
            length = min(MAX_CHUNK, group.count - offset)
            yield (
                Chunk(self.layer.interval, group.first + offset, length),
                min(length, self.count - offset),
            )


class ChunkBuffers:
    """One chunk's buffers, laid out as they lie in the clip.

    Raises ClipError where the clip's file was cut short after it was opened, OutOfGpuMemory where
    there is no room for them.
    """

    def __init__(self, context: moderngl.Context, interval: Interval, chunk: Chunk) -> None:
        check_whole(interval.tracks)
        self.context = context
        self.count = chunk.count
        self.degree = interval.degree
        self.colored = interval.start_colors is not None
        self.size = 0
        self._buffers: list[tuple[moderngl.Buffer, str, str]] = []
        self._arrays: dict[tuple[int, int], moderngl.VertexArray] = {}
        kind = "3f4" if interval.box is None else "3u2"
        movers = slice(chunk.first, chunk.first + chunk.count)
        for i, points in enumerate(interval.curve):
            self._add(points[movers], kind, f"in_point{i}")
        self._add(interval.tracks[movers], f"u{interval.tracks.itemsize}", "in_track")
        if interval.start_colors is not None and interval.end_colors is not None:
            self._add(interval.start_colors[movers], "4f1", "in_start_color")
            self._add(interval.end_colors[movers], "4f1", "in_end_color")
        try:
            check_context(context)
        except OutOfGpuMemory:
            self.release()
            raise

    def _add(self, values: np.ndarray, kind: str, name: str) -> None:
        buffer = self.context.buffer(reserve=values.nbytes + PADDING)
        buffer.write(np.ascontiguousarray(values))
        self._buffers.append((buffer, kind, name))
        self.size += buffer.size

    def array(
        self, program: moderngl.Program, places: moderngl.Buffer | None = None
    ) -> moderngl.VertexArray:
        """The buffers bound to a vertex shader's inputs, as far as it has them.

        places: which movers to draw, uint32; all of them if None.
        """
        key = (program.glo, places.glo if places else 0)
        if key not in self._arrays:
            content = [entry for entry in self._buffers if entry[2] in program]
            self._arrays[key] = self.context.vertex_array(program, content, index_buffer=places)
        return self._arrays[key]

    def bind(self) -> None:
        """Bind them as a compute shader's storage: points from 0 on, track 4, colours 5 and 6."""
        for place, (buffer, _, name) in enumerate(self._buffers):
            buffer.bind_to_storage_buffer(BINDINGS.get(name, place))

    def release(self) -> None:
        for array in self._arrays.values():
            array.release()
        for buffer, _, _ in self._buffers:
            buffer.release()


BINDINGS = {"in_track": 4, "in_start_color": 5, "in_end_color": 6}


class ChunkStore:
    """The chunks on the GPU.

    room: bytes that they may take up there together; one chunk is kept whatever its size.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, room: int) -> None:
        self._context = context
        self._clip = clip
        self._room = room
        self._kept: dict[Chunk, ChunkBuffers] = {}  # the longest unused first
        self._fetcher = Fetcher()
        self.size = 0  # bytes there now
        self.loaded = 0  # bytes brought there so far

    def __contains__(self, chunk: Chunk) -> bool:
        return chunk in self._kept

    def __getitem__(self, chunk: Chunk) -> ChunkBuffers:
        """A chunk's buffers, uploaded if they are not there yet; valid until the next one's."""
        buffers = self._kept.pop(chunk, None)
        if buffers is None:
            needed = estimate(self._clip.intervals[chunk.interval]) * chunk.count
            while self._kept and self.size + needed > self._room:
                self._drop(self._least_wanted(chunk.interval))
            buffers = self._uploaded(chunk)
            self.size += buffers.size
            self.loaded += buffers.size
        self._kept[chunk] = buffers
        return buffers

    def _uploaded(self, chunk: Chunk) -> ChunkBuffers:
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

    def load(self, ranges: list[DrawRange], seconds: float) -> list[int]:
        """Upload what is wanted for some seconds, fair samples first; then, as far as there is
        time and room, the interval after. Gives how many movers of each drawn are there: at
        least those of its first chunk.
        """
        ends = time.perf_counter() + seconds
        wanted = _fairly(ranges)
        for place, chunk in enumerate(wanted):
            if place < len(ranges) or (time.perf_counter() < ends and self._fits(chunk)):
                self[chunk]
        if all(chunk in self for chunk in wanted):
            self._load_ahead(max((p.layer.interval for p in ranges), default=-1) + 1, ends)
        return [self._present(drawn) for drawn in ranges]

    def _load_ahead(self, index: int, ends: float) -> None:
        if index >= len(self._clip.intervals):
            return
        interval = self._clip.intervals[index]
        self._fetcher.fetch(index, interval)
        for chunk in _fairly(
            [DrawRange(Layer(index, g, 0, 0, 1), g.count) for g in interval.groups]
        ):
            bytes_needed = self.size + estimate(interval) * chunk.count
            if time.perf_counter() >= ends or bytes_needed > self._room:
                return
            if chunk not in self and self._fetcher.done(index):
                self[chunk]

    def _fits(self, chunk: Chunk) -> bool:
        """Whether a chunk is there, or finds room without dropping any of its own interval."""
        kept = sum(b.size for c, b in self._kept.items() if c.interval == chunk.interval)
        needed = estimate(self._clip.intervals[chunk.interval]) * chunk.count
        return chunk in self or kept + needed <= self._room

    def _present(self, drawn: DrawRange) -> int:
        count = 0
        for chunk, length in drawn.chunks():
            if chunk not in self:
                break
            count += length
        return count

    def _least_wanted(self, shown: int) -> Chunk:
        """Of other intervals the longest unused; of the shown one the last used, so that going
        over a too large interval again and again finds its beginning in place.
        """
        others = [chunk for chunk in self._kept if chunk.interval != shown]
        return others[0] if others else next(reversed(self._kept))

    def _drop(self, chunk: Chunk) -> None:
        buffers = self._kept.pop(chunk)
        self.size -= buffers.size
        buffers.release()

    def release(self) -> None:
        self._fetcher.stop()
        for chunk in list(self._kept):
            self._drop(chunk)


def _fairly(ranges: list[DrawRange]) -> list[Chunk]:
    """The ranges' chunks, so that each prefix holds about the same share of every drawn."""
    placed = [
        (number * MAX_CHUNK / max(drawn.count, 1), chunk)
        for drawn in ranges
        for number, (chunk, _) in enumerate(drawn.chunks())
    ]
    return [chunk for _, chunk in sorted(placed, key=lambda entry: entry[0])]


def estimate(interval: Interval) -> int:
    """Bytes a mover."""
    buffers = [*interval.curve, interval.tracks]
    buffers += [c for c in (interval.start_colors, interval.end_colors) if c is not None]
    return sum(buffer.itemsize * (buffer.size // max(len(buffer), 1)) for buffer in buffers)
