"""One interval's movers: each task's transport plan turned into start and end positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.up_axis import Vertical
from baker.interpolation.resampling import surface_half_way
from baker.matching.leaflets import LeafletPair
from baker.transport.correspondences import correspond
from baker.transport.problem import TransportOptions
from baker.transport.tasks import Task
from gclip import Motion, SegmentPair
from gclip.pack import Movers

if TYPE_CHECKING:
    from baker.interpolation.births import Birth
    from baker.interpolation.timing import Timing


@dataclass(frozen=True)
class Keyframe:
    """An aligned scan, all that the movers need of it.

    positions: (N, 3) float32 about the clip's origin; colors: (N, 4) uint8 sRGB, or None.
    surface:   (N,) what each point stands for, square lengths; None where density is left as it is.
    """

    positions: NDArray[np.float32]
    colors: NDArray[np.uint8] | None
    surface: NDArray[np.floating] | None = None

    def surface_of(self, points: NDArray[np.intp]) -> NDArray[np.floating] | None:
        return None if self.surface is None else self.surface[points]


@dataclass(frozen=True)
class Moved:
    """A solved task: the movers and what is to be told of them.

    surface: (M,) what each mover stands for half-way; None where density is left as it is.
    start_points, end_points: (M,) the points of both scans that movers go from and to; None of
             what is lost.
    born:    whether they unfold from a bud.
    divided: whether the organ's leaflets were moved each on its own.
    """

    movers: Movers
    pair: SegmentPair
    surface: NDArray[np.floating] | None = None
    start_points: NDArray[np.intp] | None = None
    end_points: NDArray[np.intp] | None = None
    born: bool = False
    divided: bool = False


def solve_task(
    task: Task,
    start: Keyframe,
    end: Keyframe,
    *,
    transport: TransportOptions,
    decay: Motion,
    vertical: Vertical,
    floor: float,
    leaflets: Sequence[LeafletPair] = (),
    birth: Birth | None = None,
    timing: Timing | None = None,
) -> Moved:
    """Transport one segment through the interval from `start` to `end`.

    leaflets: the parts of a matched organ that are to go each on its own.
    birth: how a new organ unfolds; timing: of a matched one. None of what moves linearly.

    A lost organ's points keep their colour: they fall straight down to `floor`, or stay where they
    are until they have faded or are removed (section 3.3.1, decay).
    """
    if task.event == "loss":
        origin = start.positions.take(task.start, axis=0)
        landing = vertical.at_height(origin, floor) if decay is Motion.FALL else origin
        movers = _movers(task.organ, decay, origin, landing, start, task.start, start, task.start)
        drop = float(np.sqrt(((landing - origin) ** 2).sum(axis=1).mean()))
        return Moved(movers, _pair(task, len(movers), "identity", drop, 0.0))

    here = start.positions.take(task.start, axis=0)
    there = end.positions.take(task.end, axis=0)
    found = correspond(here, there, transport, leaflets)
    a, b = task.start[found.rows], task.end[found.columns]
    origin, target = here.take(found.rows, axis=0), there.take(found.columns, axis=0)
    movers = _movers(task.organ, Motion.MOVE, origin, target, start, a, end, b)
    pair = _pair(task, len(movers), found.solver, found.distance, found.marginal_error, found.notes)
    if birth is not None:
        origin, target = movers.curve
        curve = (origin, birth.control(origin, target), target)
        movers = replace(movers, curve=curve)
    if timing is not None:
        origin, target = movers.curve
        # Of a curve of degree two the control point counts half in its middle.
        control = (origin + target) / 2 + 2.0 * timing.shift(origin, target)
        movers = replace(movers, curve=(origin, control.astype(np.float32), target))
    born = task.event == "birth"
    before, after = start.surface_of(task.start), end.surface_of(task.end)
    surface = surface_half_way(before, found.rows, after, found.columns, born)
    return Moved(movers, pair, surface, a, b, born, found.divided)


def _movers(
    organ: int,
    motion: Motion,
    origin: NDArray[np.float32],
    target: NDArray[np.float32],
    start: Keyframe,
    a: NDArray[np.intp],
    end: Keyframe,
    b: NDArray[np.intp],
) -> Movers:
    colored = start.colors is not None and end.colors is not None
    return Movers(
        motion=motion,
        curve=(origin, target),
        tracks=np.full(len(a), organ),
        start_colors=start.colors.take(a, axis=0) if colored and start.colors is not None else None,
        end_colors=end.colors.take(b, axis=0) if colored and end.colors is not None else None,
    )


def _pair(
    task: Task, movers: int, solver: str, cost: float, error: float, notes: tuple[str, ...] = ()
) -> SegmentPair:
    return SegmentPair(
        track=task.organ,
        event=task.event,
        start_points=len(task.start),
        end_points=len(task.end),
        movers=movers,
        solver=solver,
        cost=cost,
        marginal_error=error,
        notes=notes,
    )
