"""An interval's movers on the GPU: written once, drawn many times."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import moderngl

    from gclip import Clip, Interval

KEPT = 3  # intervals on the GPU at once: the one before (its litter), the one shown, the one after


class IntervalBuffers:
    """The vertex buffers of one interval, laid out as they lie in the clip."""

    def __init__(self, context: moderngl.Context, interval: Interval) -> None:
        self.context = context
        self.degree = interval.degree
        self.colored = interval.start_colors is not None
        kind = "3f4" if interval.box is None else "3u2"
        self.attributes = [
            (context.buffer(np.ascontiguousarray(points)), kind, f"in_point{i}")
            for i, points in enumerate(interval.curve)
        ]
        tracks = np.ascontiguousarray(interval.tracks)
        self.attributes.append((context.buffer(tracks), f"u{tracks.itemsize}", "in_track"))
        for name in ("start_color", "end_color"):
            colors = getattr(interval, f"{name}s")
            if colors is not None:
                buffer = context.buffer(np.ascontiguousarray(colors))
                self.attributes.append((buffer, "4f1", f"in_{name}"))
        self.arrays: dict[int, moderngl.VertexArray] = {}

    def array(self, program: moderngl.Program) -> moderngl.VertexArray:
        """The buffers bound to a program's inputs, as far as it has them."""
        if program.glo not in self.arrays:
            content = [attribute for attribute in self.attributes if attribute[2] in program]
            self.arrays[program.glo] = self.context.vertex_array(program, content)
        return self.arrays[program.glo]

    def release(self) -> None:
        for array in self.arrays.values():
            array.release()
        for buffer, _, _ in self.attributes:
            buffer.release()


class BufferCache:
    """The intervals that were drawn last."""

    def __init__(self, context: moderngl.Context, clip: Clip) -> None:
        self._make: Callable[[int], IntervalBuffers] = lambda index: IntervalBuffers(
            context, clip.intervals[index]
        )
        self._kept: OrderedDict[int, IntervalBuffers] = OrderedDict()

    def __getitem__(self, index: int) -> IntervalBuffers:
        if index not in self._kept:
            while len(self._kept) >= KEPT:
                self._kept.popitem(last=False)[1].release()
            self._kept[index] = self._make(index)
        self._kept.move_to_end(index)
        return self._kept[index]

    def release(self) -> None:
        for buffers in self._kept.values():
            buffers.release()
        self._kept.clear()
