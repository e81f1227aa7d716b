"""A clip's points in GPU memory: vertex buffers that are filled step by step and freed on demand.

The points of a group are ordered so that every prefix is a representative sample (docs/format.md).
A group is divided into chunks in this order, and chunks are uploaded in slices. The points on the
GPU therefore always cover the whole plant, although with fewer points.
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
from player.gl.context import total_gpu_memory
from player.gl.gl_errors import OutOfGpuMemory, check_context

# Range of the bytes of a chunk's positions (16 to 89 million points), and their share of memory:
# large chunks need few commands, but OpenGL guarantees only 65,535 workgroups for each.
BUFFER_SIZES, BUFFER_SHARE = (96 << 20, 512 << 20), 1 / 32
SLICE = 1 << 20  # number of points that are uploaded at once
MEMORY_SHARE = 0.6  # of the GPU's memory; the rest is left to framebuffers and other programs
PADDING = 96  # bytes behind the last point, because compute shaders read eight points at once


class Chunk(NamedTuple):
    """Consecutive points of one group of an interval."""

    interval: int  #: index of the interval in the clip
    first: int  #: index of the first point in the interval
    length: int  #: number of points


@dataclass(frozen=True)
class DrawRange:
    """The points of a layer that are drawn."""

    layer: Layer
    count: int  #: number of points from the layer's first one, a representative sample
    #: every n-th of these points is drawn, or by compute shaders every n-th group of eight; points
    #: in sequence are neighbours on the plant, so this leaves no gaps
    stride: int = 1

    @property
    def missing(self) -> int:
        """Number of the layer's points that are not on the GPU yet."""
        return self.layer.group.count - self.count


def full_ranges(layers: list[Layer], stride: int = 1) -> list[DrawRange]:
    """Draw ranges of all points of layers, or of every n-th point."""
    return [DrawRange(layer, layer.group.count, stride) for layer in layers]


class Attribute(NamedTuple):
    """A vertex attribute: one entry for each point of an interval."""

    values: NDArray
    format: str  #: of an entry, in moderngl's notation
    name: str  #: in vertex shaders (point_attributes.glsl)
    location: int  #: in vertex shaders, and binding in compute shaders (point_storage.glsl)


def attributes_of(interval: Interval) -> list[Attribute]:
    """The vertex attributes of an interval."""
    position = "3f4" if interval.box is None else "3u2"
    candidates: list[tuple[NDArray | None, str, str, int]] = [
        *((points, position, f"in_point{i}", i) for i, points in enumerate(interval.curve)),
        (interval.tracks, f"u{interval.tracks.itemsize}", "in_track", 4),
        (interval.start_colors, "4f1", "in_start_color", 5),
        (interval.end_colors, "4f1", "in_end_color", 6),
        (interval.normals, "4f1", "in_normals", 7),
    ]
    return [Attribute(v, kind, name, at) for v, kind, name, at in candidates if v is not None]


def bytes_per_point(interval: Interval) -> int:
    """Bytes of one point in all vertex buffers of an interval."""
    return sum(values[:1].nbytes for values, *_ in attributes_of(interval))


class ChunkBuffers:
    """The vertex buffers of one chunk, in the clip's own layout, filled from the beginning.

    Raises OutOfGpuMemory if they do not fit.
    """

    def __init__(self, context: moderngl.Context, interval: Interval, chunk: Chunk) -> None:
        self._context = context
        self._first = chunk.first
        self._arrays: dict[tuple[int, int], moderngl.VertexArray] = {}
        self._buffers: list[tuple[Attribute, moderngl.Buffer]] = []
        for attribute in attributes_of(interval):
            size = attribute.values[:1].nbytes * chunk.length + PADDING
            self._buffers.append((attribute, context.buffer(reserve=size)))
        self.size = sum(buffer.size for _, buffer in self._buffers)
        self.resident = 0  # number of points that are uploaded
        check_context(context)

    def upload(self, stop: int) -> None:
        """Upload the points up to the chunk's point `stop`."""
        pending = slice(self._first + self.resident, self._first + stop)
        for (values, *_), buffer in self._buffers:
            points = np.ascontiguousarray(values[pending])
            buffer.write(points, offset=self.resident * values[:1].nbytes)
        self.resident = stop

    def array(
        self, program: moderngl.Program, indices: moderngl.Buffer | None = None
    ) -> moderngl.VertexArray:
        """The vertex array for a program, with the attributes that the program reads.

        indices: uint32 indices of the points to draw; all points by default.
        """
        key = (program.glo, indices.glo if indices else 0)
        if key not in self._arrays:
            content = [(b, a.format, a.name) for a, b in self._buffers if a.name in program]
            self._arrays[key] = self._context.vertex_array(program, content, index_buffer=indices)
        return self._arrays[key]

    def bind(self) -> None:
        """Bind the buffers as storage buffers of a compute shader."""
        for attribute, buffer in self._buffers:
            buffer.bind_to_storage_buffer(attribute.location)


class PointBuffers:
    """A cache of a clip's chunks on the GPU; `loaded` counts the slices uploaded so far.

    memory: bytes for all chunks together, by default a share of the GPU's memory; a single chunk is
            kept whatever its size.
    """

    def __init__(self, context: moderngl.Context, clip: Clip, memory: int | None = None) -> None:
        self._context = context
        self._clip = clip
        self._capacity = int(MEMORY_SHARE * total_gpu_memory(context)) if memory is None else memory
        allowed = context.info.get("GL_MAX_SHADER_STORAGE_BLOCK_SIZE", 0)
        size = min(allowed - PADDING, int(BUFFER_SHARE * self._capacity))
        self._buffer_size = int(np.clip(size, *BUFFER_SIZES))
        self._kept: dict[Chunk, ChunkBuffers] = {}  # least recently used first
        self.loaded = 0

    def size(self, intervals: Set[int] | None = None) -> int:
        """Bytes that the chunks of some intervals occupy, by default of all intervals."""
        kept = self._kept.items()
        return sum(b.size for chunk, b in kept if intervals is None or chunk.interval in intervals)

    def chunk_length(self, interval: Interval) -> int:
        """Number of points in the longest chunk of an interval."""
        return max(min(len(interval), self._buffer_size // (3 * interval.curve[0].itemsize)), 1)

    def chunks(self, drawn: DrawRange) -> Iterator[tuple[Chunk, int]]:
        """Yield the chunks of a range, and the number of points of each that are drawn."""
        layer, group = drawn.layer, drawn.layer.group
        length = self.chunk_length(self._clip.intervals[layer.interval])
        for offset in range(0, drawn.count, length):
            count = min(length, group.count - offset)
            chunk = Chunk(layer.interval, group.first + offset, count)
            yield chunk, min(count, drawn.count - offset)

    def resident(self, drawn: DrawRange) -> int:
        """Number of a range's points, counted from its first one, that are on the GPU."""
        resident = 0
        for chunk, count in self.chunks(drawn):
            in_chunk = min(self._kept[chunk].resident, count) if chunk in self._kept else 0
            resident += in_chunk
            if in_chunk < count:
                break
        return resident

    def fetch(self, chunk: Chunk, count: int) -> ChunkBuffers:
        """A chunk's buffers with at least `count` points uploaded; valid until the next call."""
        buffers = self._kept.pop(chunk, None) or self._allocate(chunk)
        self._kept[chunk] = buffers
        while buffers.resident < count:
            buffers.upload(min(buffers.resident + SLICE, count))
            self.loaded += 1
        return buffers

    def load(self, wanted: list[DrawRange], seconds: float) -> list[DrawRange]:
        """Upload ranges evenly, and then those of the next interval, within some seconds.

        At least one slice of each range is uploaded. Returns the points of the ranges that are on
        the GPU.
        """
        deadline = time.perf_counter() + seconds
        for drawn in wanted:
            for chunk, count in islice(self.chunks(drawn), 1):
                self.fetch(chunk, min(count, SLICE))
        shown = {drawn.layer.interval for drawn in wanted}
        ahead = full_ranges(layers_at(self._clip, self._clip.intervals[max(shown, default=0)].end))
        following = shown | {drawn.layer.interval for drawn in ahead}
        while time.perf_counter() < deadline and (
            self._upload_slice(wanted, shown) or self._upload_slice(ahead, following)
        ):
            pass
        return [replace(drawn, count=self.resident(drawn)) for drawn in wanted]

    def _upload_slice(self, ranges: list[DrawRange], kept_intervals: Set[int]) -> bool:
        """Upload a slice of the range of which the smallest share is on the GPU.

        Returns False if all ranges are complete, or the slice needs a new chunk that does not fit
        beside the chunks of `kept_intervals`.
        """
        resident = {r: count for r in ranges if (count := self.resident(r)) < r.count}
        if not resident:
            return False
        drawn = min(resident, key=lambda r: resident[r] / r.count)
        length = self.chunk_length(self._clip.intervals[drawn.layer.interval])
        chunk, count = next(islice(self.chunks(drawn), resident[drawn] // length, None))
        room = self._capacity - self.size(kept_intervals)
        if chunk not in self._kept and self._bytes(chunk) > room:
            return False
        self.fetch(chunk, min(resident[drawn] % length + SLICE, count))
        return True

    def _bytes(self, chunk: Chunk) -> int:
        return bytes_per_point(self._clip.intervals[chunk.interval]) * chunk.length

    def _allocate(self, chunk: Chunk) -> ChunkBuffers:
        """Allocate buffers for a chunk, and free others if necessary.

        The least recently used chunks of other intervals are freed first. Then the most recently
        used ones are, so that an interval that is larger than the memory keeps its first chunks.
        """
        while True:
            while self._kept and self.size() + self._bytes(chunk) > self._capacity:
                others = (kept for kept in self._kept if kept.interval != chunk.interval)
                del self._kept[next(others, None) or next(reversed(self._kept))]
            self._context.gc()
            try:
                return ChunkBuffers(self._context, self._clip.intervals[chunk.interval], chunk)
            except OutOfGpuMemory:  # less memory is free than the driver reports
                if not self._kept:
                    raise
                self._capacity = self.size() // 2 + self._bytes(chunk)
