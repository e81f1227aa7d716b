"""A clip's points on the GPU: vertex buffers that are filled, and freed where room is short.

The points of a group are ordered so that every prefix is a representative sample (docs/format.md).
A group is cut into chunks in this order, and chunks are filled slice by slice. Therefore the points
on the GPU always show the whole plant, if with fewer points.
"""

import time
from collections.abc import Iterator, Set
from dataclasses import dataclass, replace
from itertools import islice
from typing import NamedTuple

import moderngl
import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Interval
from gclip.evaluate import Layer, layers_at
from player.gl.gl_errors import OutOfGpuMemory, check_context
from player.gl.gpu_memory import total

MAX_BUFFER = 96 << 20  # bytes of a chunk's positions (16 M points); any OpenGL allows as much
SLICE = 1 << 20  # points that are uploaded at a time
SHARE = 0.6  # of the GPU's memory; the rest is left to pictures and to other programs
PADDING = 48  # bytes, because compute shaders read four points at a time


@dataclass(frozen=True)
class Chunk:
    """Consecutive points of one group of an interval."""

    interval: int
    first: int
    count: int


@dataclass(frozen=True)
class DrawRange:
    """The points of a layer that are drawn.

    count:  number of points from the first on: a representative sample, in blocks of neighbours.
    stride: of these every n-th point is drawn, or every n-th group of four neighbours, which leaves
            no gaps.
    """

    layer: Layer
    count: int
    stride: int = 1

    @property
    def missing(self) -> int:
        """Number of the layer's other points, which are not on the GPU yet."""
        return self.layer.group.count - self.count


def whole(layers: list[Layer], stride: int = 1) -> list[DrawRange]:
    """Ranges of all points of some layers, or of every n-th one."""
    return [DrawRange(layer, layer.group.count, stride) for layer in layers]


class Attribute(NamedTuple):
    """A buffer of an interval with one entry a point."""

    values: NDArray
    kind: str  #: of an entry, as moderngl writes it
    name: str  #: in vertex shaders (point_attributes.glsl)
    location: int  #: there; in compute shaders the binding (point_storage.glsl)


def attributes_of(interval: Interval) -> list[Attribute]:
    """The buffers of an interval with one entry a point."""
    position = "3f4" if interval.box is None else "3u2"
    found: list[tuple[NDArray | None, str, str, int]] = [
        *((points, position, f"in_point{i}", i) for i, points in enumerate(interval.curve)),
        (interval.tracks, f"u{interval.tracks.itemsize}", "in_track", 4),
        (interval.start_colors, "4f1", "in_start_color", 5),
        (interval.end_colors, "4f1", "in_end_color", 6),
        (interval.normals, "4f1", "in_normals", 7),
    ]
    return [Attribute(one, kind, name, at) for one, kind, name, at in found if one is not None]


def chunk_length(interval: Interval) -> int:
    """Number of points in a chunk of an interval."""
    return MAX_BUFFER // (3 * interval.curve[0].itemsize)


def bytes_per_point(interval: Interval) -> int:
    """Bytes of one point in all buffers of an interval."""
    return sum(values[:1].nbytes for values, *_ in attributes_of(interval))


class ChunkBuffers:
    """The vertex buffers of one chunk, in the clip's layout, filled from the beginning.

    Raises OutOfGpuMemory if they don't fit.
    """

    def __init__(self, context: moderngl.Context, interval: Interval, chunk: Chunk) -> None:
        self._context = context
        self._first = chunk.first
        self._arrays: dict[tuple[int, int], moderngl.VertexArray] = {}
        self._buffers: list[tuple[Attribute, moderngl.Buffer]] = []
        for attribute in attributes_of(interval):
            size = attribute.values[:1].nbytes * chunk.count + PADDING
            self._buffers.append((attribute, context.buffer(reserve=size)))
        self.size = sum(buffer.size for _, buffer in self._buffers)
        self.resident = 0  # points that are uploaded
        check_context(context)

    def upload(self, stop: int) -> None:
        """Upload the points up to the chunk's point `stop`."""
        some = slice(self._first + self.resident, self._first + stop)
        for (values, *_), buffer in self._buffers:
            points = np.ascontiguousarray(values[some])
            buffer.write(points, offset=self.resident * values[:1].nbytes)
        self.resident = stop

    def array(
        self, program: moderngl.Program, indices: moderngl.Buffer | None = None
    ) -> moderngl.VertexArray:
        """The vertex array for a program; attributes that the program lacks are left out.

        indices: uint32 numbers of the points to draw; all points by default.
        """
        key = (program.glo, indices.glo if indices else 0)
        if key not in self._arrays:
            content = [(b, a.kind, a.name) for a, b in self._buffers if a.name in program]
            self._arrays[key] = self._context.vertex_array(program, content, index_buffer=indices)
        return self._arrays[key]

    def bind(self) -> None:
        """Bind the buffers as storage buffers of a compute shader."""
        for attribute, buffer in self._buffers:
            buffer.bind_to_storage_buffer(attribute.location)


class PointBuffers:
    """A clip's chunks on the GPU.

    memory: bytes for all chunks together, by default a share of the GPU's memory; a single chunk
            is kept whatever its size.
    loaded: number of slices uploaded so far.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, memory: int | None = None) -> None:
        self._context = context
        self._clip = clip
        self._room = int(SHARE * total(context)) if memory is None else memory
        self._kept: dict[Chunk, ChunkBuffers] = {}  # least recently used first
        self.loaded = 0

    def size(self, intervals: Set[int] | None = None) -> int:
        """Bytes that the chunks of some intervals occupy, or all chunks."""
        return sum(
            buffers.size
            for chunk, buffers in self._kept.items()
            if intervals is None or chunk.interval in intervals
        )

    def chunks(self, drawn: DrawRange) -> Iterator[tuple[Chunk, int]]:
        """The chunks of a range, and how many points of each are drawn."""
        layer, group = drawn.layer, drawn.layer.group
        length = chunk_length(self._clip.intervals[layer.interval])
        for offset in range(0, drawn.count, length):
            count = min(length, group.count - offset)
            chunk = Chunk(layer.interval, group.first + offset, count)
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
        buffers = self._kept.pop(chunk, None) or self._allocated(chunk)
        self._kept[chunk] = buffers
        while buffers.resident < count:
            buffers.upload(min(buffers.resident + SLICE, count))
            self.loaded += 1
        return buffers

    def load(self, wanted: list[DrawRange], seconds: float) -> list[DrawRange]:
        """Upload ranges for some seconds, evenly, and then those of the following interval, as far
        as time and memory allow. Returns what of the ranges is on the GPU: at least a slice each.
        """
        ends = time.perf_counter() + seconds
        for drawn in wanted:
            for chunk, count in islice(self.chunks(drawn), 1):
                self.fetch(chunk, min(count, SLICE))
        shown = {drawn.layer.interval for drawn in wanted}
        ahead = whole(layers_at(self._clip, self._clip.intervals[max(shown, default=0)].end))
        following = shown | {drawn.layer.interval for drawn in ahead}
        while time.perf_counter() < ends and (
            self._upload_slice(wanted, shown) or self._upload_slice(ahead, following)
        ):
            pass
        return [replace(drawn, count=self.resident(drawn)) for drawn in wanted]

    def _upload_slice(self, ranges: list[DrawRange], keeping: Set[int]) -> bool:
        """Upload a slice of that range of which the least is there; False if all is there, or no
        more of it fits beside the chunks of some intervals.
        """
        behind = {one: there for one in ranges if (there := self.resident(one)) < one.count}
        if not behind:
            return False
        drawn = min(behind, key=lambda one: behind[one] / one.count)
        length = chunk_length(self._clip.intervals[drawn.layer.interval])
        chunk, count = next(islice(self.chunks(drawn), behind[drawn] // length, None))
        if chunk not in self._kept and self._bytes(chunk) + self.size(keeping) > self._room:
            return False
        self.fetch(chunk, min(behind[drawn] % length + SLICE, count))
        return True

    def _bytes(self, chunk: Chunk) -> int:
        return bytes_per_point(self._clip.intervals[chunk.interval]) * chunk.count

    def _allocated(self, chunk: Chunk) -> ChunkBuffers:
        """Buffers for a chunk. To make room others are freed: the least recently used chunk of
        other intervals, else the most recently used one, so that an interval that is larger than
        the memory keeps its first chunks.
        """
        while True:
            while self._kept and self.size() + self._bytes(chunk) > self._room:
                others = (kept for kept in self._kept if kept.interval != chunk.interval)
                del self._kept[next(others, None) or next(reversed(self._kept))]
            self._context.gc()
            try:
                return ChunkBuffers(self._context, self._clip.intervals[chunk.interval], chunk)
            except OutOfGpuMemory:  # the GPU has less memory than reported
                if not self._kept:
                    raise
                self._room = self.size() // 2 + self._bytes(chunk)
