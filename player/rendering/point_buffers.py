"""Vertex buffers that hold chunks of a clip's points, and the ranges of points to draw."""

from dataclasses import dataclass, replace
from typing import Self

import moderngl
import numpy as np
from numpy.typing import NDArray

from gclip import Interval
from gclip.evaluate import Layer
from gclip.file import check_not_truncated
from player.gl.gl_errors import check_context

MAX_BUFFER = 96 << 20  # bytes of a chunk's positions (16 M points); any OpenGL allows as much
SLICE = 1 << 20  # points that are uploaded at a time
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
    def total(self) -> int:
        """Number of points of the layer."""
        return self.layer.group.count

    @property
    def points(self) -> int:
        """Number of points that are drawn."""
        return -(-self.count // self.stride)

    def reduced(self, most: int, share: float) -> Self:
        """A range of about this share of the points, taken from the first `most` of them."""
        stride = max(round(self.stride / share), 1)
        return replace(self, count=min(self.count, most), stride=stride)


def attributes_of(interval: Interval) -> list[tuple[NDArray, str, str, int]]:
    """An interval's buffers with one entry a point: values, moderngl's format of an entry, name and
    location of the shader's attribute.
    """
    position = "3f4" if interval.box is None else "3u2"
    found: list[tuple[NDArray | None, str, str, int]] = [
        *((points, position, f"in_point{i}", i) for i, points in enumerate(interval.curve)),
        (interval.tracks, f"u{interval.tracks.itemsize}", "in_track", 4),
        (interval.start_colors, "4f1", "in_start_color", 5),
        (interval.end_colors, "4f1", "in_end_color", 6),
        (interval.normals, "4f1", "in_normals", 7),
    ]
    return [(one, kind, name, at) for one, kind, name, at in found if one is not None]


def buffers_of(interval: Interval) -> list[NDArray]:
    """An interval's buffers with one entry a point."""
    return [values for values, *_ in attributes_of(interval)]


def chunk_length(interval: Interval) -> int:
    """Number of points in a chunk of an interval."""
    return MAX_BUFFER // (3 * interval.curve[0].itemsize)


def bytes_per_point(interval: Interval) -> int:
    """Bytes of one point in all buffers of an interval."""
    return sum(buffer[:1].nbytes for buffer in buffers_of(interval))


class ChunkBuffers:
    """The vertex buffers of one chunk, in the clip's layout, filled from the beginning.

    Raises OutOfGpuMemory if they don't fit.
    """

    def __init__(self, context: moderngl.Context, interval: Interval, chunk: Chunk) -> None:
        self._context = context
        self._interval = interval
        self._chunk = chunk
        self._arrays: dict[tuple[int, int], moderngl.VertexArray] = {}
        self.resident = 0  # points that are uploaded
        self._buffers: list[tuple[moderngl.Buffer, str, str, int]] = []
        for values, kind, name, location in attributes_of(interval):
            size = values[:1].nbytes * chunk.count + PADDING
            self._buffers.append((context.buffer(reserve=size), kind, name, location))
        self.size = sum(buffer.size for buffer, *_ in self._buffers)
        check_context(context)

    def upload(self, count: int) -> int:
        """Upload the next slice of the first `count` points; returns the bytes uploaded.

        Raises ClipError if the clip's file was truncated after it was opened.
        """
        stop = min(count, self._chunk.count, self.resident + SLICE)
        if stop <= self.resident:
            return 0
        check_not_truncated(self._interval.tracks)
        some = slice(self._chunk.first + self.resident, self._chunk.first + stop)
        came = 0
        for values, (buffer, *_) in zip(buffers_of(self._interval), self._buffers, strict=True):
            points = np.ascontiguousarray(values[some])
            buffer.write(points, offset=self.resident * values[:1].nbytes)
            came += points.nbytes
        self.resident = stop
        return came

    def array(
        self, program: moderngl.Program, indices: moderngl.Buffer | None = None
    ) -> moderngl.VertexArray:
        """The vertex array for a program; attributes that the program lacks are left out.

        indices: uint32 numbers of the points to draw; all points by default.
        """
        key = (program.glo, indices.glo if indices else 0)
        if key not in self._arrays:
            content = [(b, kind, name) for b, kind, name, _ in self._buffers if name in program]
            self._arrays[key] = self._context.vertex_array(program, content, index_buffer=indices)
        return self._arrays[key]

    def bind(self) -> None:
        """Bind the buffers as storage buffers of a compute shader (point_storage.glsl)."""
        for buffer, _, _, binding in self._buffers:
            buffer.bind_to_storage_buffer(binding)
