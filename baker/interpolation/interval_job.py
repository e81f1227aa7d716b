"""Solve single intervals: independent jobs for threads, processes or other machines."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from baker.alignment.keyframes import AlignedSeries, Keyframe
from baker.geometry.parallel import MapLike, ReportProgress, reporting, thread_map
from baker.geometry.up_axis import Vertical
from baker.interpolation.movers import OrganPaths, child_deviations, lost_organ_movers, organ_movers
from baker.interpolation.organ_motion import OrganMotion, fit_motion
from baker.interpolation.organ_shapes import (
    Attachments,
    OrganShape,
    organ_attachments,
    organ_shapes,
)
from baker.interpolation.packing import pack_interval
from baker.interpolation.smoothing import smooth_organs
from baker.interpolation.timing import Timing, organ_timings
from baker.matching.leaflets import LeafletPair, match_leaflets
from baker.matching.match import Match
from baker.options import Options
from baker.transport.correspondences import correspond
from baker.transport.problem import TransportOptions
from baker.transport.tasks import Task
from gclip import Interval, Motion

MIN_ELONGATION = 16.0  # of the organs of a grass: least median of `OrganShape.elongation`
SMALL_SHARE = 0.5  # greatest share of all small organs, relative to an equal one for each thread


@dataclass(frozen=True)
class IntervalJob:
    """The input from which the movers of one interval are computed."""

    times: tuple[float, float]  # of the two scans
    start: Keyframe
    end: Keyframe
    match: Match
    bases: tuple[NDArray[np.floating], NDArray[np.floating]]  # (3,) plant bases
    tasks: tuple[Task, ...]  # the organs that are matched, born or lost
    timings: Mapping[int, Timing]  # organ -> timing, unless it moves evenly
    vertical: Vertical
    decays: Mapping[int, Motion]  # lost organ -> motion
    floor: float  # height to which lost organs fall; 0 if none falls
    attachments: tuple[Attachments, Attachments]  # of matched organs, in both scans
    spacing: float  # mean point spacing of the two scans
    transport: TransportOptions  # its `workers` is ignored
    is_registered: bool  # whether organs are registered non-rigidly before they are transported
    is_curved: bool  # whether organs deform along curved paths and move with their parents
    growth: float  # see `with_even_density`
    precision: str  # see `pack_interval`


def interval_jobs(
    series: AlignedSeries,
    matches: Sequence[Match],
    tasks: Sequence[tuple[Task, ...]],
    options: Options,
    unlabelled: bool,
) -> list[IntervalJob]:
    """Make the job of each interval, and compute what depends on several intervals.

    matches, tasks: of each interval. options: resolved. unlabelled: whether organs were found
    without labels. Most lost organs are then parts of a leaf that is segmented differently in the
    next scan, so they fade instead of falling.
    """
    is_curved = options.paths == "curved"
    spacings, bases = series.spacings, series.base_points
    clouds, keyframes = [*series.clouds], series.keyframes
    attachments = organ_attachments(clouds, spacings, matches)
    if options.smooth:
        hierarchies = [matches[0].first, *(match.second for match in matches)]
        clouds = smooth_organs(clouds, hierarchies, attachments, series.times)
        frames = zip(keyframes, clouds, strict=True)
        keyframes = tuple(replace(frame, positions=cloud) for frame, cloud in frames)
        attachments = organ_attachments(clouds, spacings, matches)
    timings: list[dict[int, Timing]] = [{} for _ in matches]
    if is_curved and len(matches) > 1:
        timings = organ_timings(clouds, matches, series.times, series.spacing)
    transport = TransportOptions(  # the paper's costs are plain distances on a kNN support
        method="sinkhorn" if options.transport == "sinkhorn" else "exact",
        power=1 if options.paper else 2,
        neighbors=options.neighbors,
        gamma=options.gamma,
        tolerance=options.tolerance,
        iterations=options.iterations,
        feasible=not options.paper,
    )
    decays = _decays(tasks, matches, Motion(options.decay), unlabelled)
    return [
        IntervalJob(
            times=(series.times[k], series.times[k + 1]),
            start=keyframes[k],
            end=keyframes[k + 1],
            match=matches[k],
            bases=(bases[k], bases[k + 1]),
            tasks=tasks[k],
            timings=timings[k],
            vertical=series.vertical,
            decays=decays[k],
            floor=series.floor if Motion.FALL in decays[k].values() else 0.0,
            attachments=(attachments[k], attachments[k + 1]),
            spacing=(spacings[k] + spacings[k + 1]) / 2,
            transport=transport,
            is_registered=not (options.paper or options.whole),
            is_curved=is_curved,
            growth=options.even or 0.0,
            precision=options.precision,
        )
        for k in range(len(matches))
    ]


def _decays(
    tasks: Sequence[tuple[Task, ...]], matches: Sequence[Match], decay: Motion, unlabelled: bool
) -> list[dict[int, Motion]]:
    """The motion of each lost organ; an organ that reappears in a later scan does not fall."""
    decays, later_organs = [], set[int]()
    for interval, match in zip(reversed(tasks), reversed(matches), strict=True):
        lost = {task.organ for task in interval if task.event == "loss"}
        fading = lost if unlabelled else lost & later_organs
        fading = fading if decay is Motion.FALL else set()
        decays.append({organ: Motion.FADE if organ in fading else decay for organ in lost})
        later_organs |= {*match.second.organs}
    return decays[::-1]


def solve_intervals(
    jobs: Sequence[IntervalJob], report_progress: ReportProgress, workers: int = 1
) -> Iterator[Interval]:
    """Solve intervals in threads: one interval a thread or, if there are fewer, organs of it.

    Yields the intervals in the order of the jobs; they don't depend on `workers`, the number of
    threads. report_progress: called with the number of steps done and their total.
    """
    with thread_map(workers) as map:
        if len(jobs) < workers:
            # Batches of organs, the packing and, where organs are registered, two scans' shapes.
            solving = [sum(map(len, _phases(job, workers))) for job in jobs]
            steps = [n + 1 + 2 * job.is_registered for n, job in zip(solving, jobs, strict=True)]
            map = reporting(map, report_progress, sum(steps))
            yield from (solve_interval(job, map, workers) for job in jobs)
            return
        map = reporting(map, report_progress, len(jobs))
        # The largest intervals first, so that threads finish at about the same time.
        order = sorted(range(len(jobs)), key=lambda k: -len(jobs[k].end.positions))
        solved = dict(zip(order, map(solve_interval, [jobs[k] for k in order]), strict=True))
        yield from (solved[k] for k in range(len(jobs)))


def solve_interval(job: IntervalJob, map: MapLike = map, workers: int = 1) -> Interval:
    """Solve one interval; the result does not depend on `map` and `workers`.

    map: maps over batches of organs, in threads. workers: number of threads for the transport of an
    organ with more points than an equal share for each thread.
    """
    clouds, scan = (job.start.positions, job.end.positions), job.match.second
    shapes: Sequence[Mapping[int, OrganShape]] = {}, {}
    if job.is_registered:
        match = job.match
        matched = [a for a, _ in match.pairs], [b for _, b in match.pairs]
        sides = (match.first, match.second), job.bases, job.attachments, matched
        shapes = list(map(organ_shapes, clouds, *sides))
    # Leaves of grasses become strips, and grow at their base; broad leaves grow everywhere.
    elongations = [shape.elongation for shape in shapes[1].values()] or [0.0]
    grows_at_base = float(np.median(elongations)) > MIN_ELONGATION
    total = sum(task.size for task in job.tasks)
    solved: dict[int, OrganPaths] = {}  # track id of an organ -> its paths

    def solve(task: Task) -> OrganPaths:
        if task.origin:
            parent, contact = task.origin
            task = replace(task, start=solved[parent].bud(contact, clouds[0]))
        start, end = clouds[0].take(task.start, axis=0), clouds[1].take(task.end, axis=0)
        motion: OrganMotion | None = None
        parts: Sequence[LeafletPair] = ()
        if all(task.organ in side for side in shapes):
            before, after = (side[task.organ] for side in shapes)
            motion, parts = _register_organ(start, end, before, after, grows_at_base)
        threads = workers if task.size * workers > total else 1
        plan = correspond(start, end, replace(job.transport, workers=threads), parts)
        paths, sources = OrganPaths(task, plan), start.take(plan.rows, axis=0)
        if timing := job.timings.get(task.organ):
            target = end.take(plan.columns, axis=0)
            paths = replace(paths, deviation=timing.shift(sources, target))
        if motion is None or not job.is_curved or task.organ == scan.organs[scan.root]:
            return paths
        deviation = paths.deviation + motion.deviation(start).take(plan.rows, axis=0)
        of_children = child_deviations(task.organ, motion, clouds[1], scan)
        return replace(paths, deviation=deviation, child_deviations=of_children)

    def solve_batch(batch: list[Task]) -> list[OrganPaths]:
        return [solve(task) for task in batch]

    for batches in _phases(job, workers):
        solved |= {organ.task.organ: organ for organ in chain(*map(solve_batch, batches))}
    paths = [solved[task.organ] for task in job.tasks if task.event != "loss"]
    # In a thread of the map, which uses the memory of the transport again.
    (interval,) = map(_packed, [paths], [job])
    return interval


def _phases(job: IntervalJob, workers: int) -> list[list[list[Task]]]:
    """Batches of tasks for threads; new organs that grow on others are solved after these."""
    tasks = [task for task in job.tasks if task.event != "loss"]
    phases = [task for task in tasks if not task.origin], [task for task in tasks if task.origin]
    return [_batches(phase, workers) for phase in phases if phase]


def _batches(tasks: Sequence[Task], workers: int) -> list[list[Task]]:
    """Batches of tasks for threads: of each large organ, and of all small ones together.

    Small organs hold the interpreter's lock for most of their time, so one thread solves them while
    others solve large ones. The largest come first, so that threads finish at about the same time.
    """
    ascending = sorted(tasks, key=attrgetter("size"))
    sizes = np.cumsum([task.size for task in ascending])
    small = int(np.searchsorted(sizes, SMALL_SHARE * sizes[-1] / workers))
    large = [[task] for task in reversed(ascending[small:])]
    return [*large[:1], ascending[:small], *large[1:]]


def _packed(paths: Sequence[OrganPaths], job: IntervalJob) -> Interval:
    """Pack the movers of all organs of an interval."""
    lost = [
        lost_organ_movers(task, job.start, job.decays[task.organ], job.vertical, job.floor)
        for task in job.tasks
        if task.event == "loss"
    ]
    moved = organ_movers(paths, job.start, job.end, job.match.second, job.growth) if paths else []
    return pack_interval(
        *job.times,
        [*moved, *(movers for movers, _ in lost)],
        spacing=job.spacing,
        precision=job.precision,
        segments=(*(organ.pair for organ in paths), *(pair for _, pair in lost)),
    )


def _register_organ(
    start: NDArray[np.floating],
    end: NDArray[np.floating],
    source: OrganShape,
    target: OrganShape,
    grows_at_base: bool,
) -> tuple[OrganMotion | None, Sequence[LeafletPair]]:
    """The motion of an organ, and its parts that are transported separately.

    An organ with leaflets has no single spine, and therefore no motion.
    """
    children = sorted(source.nodes.keys() & target.nodes.keys())
    first = _attachment_points(start, source, children)
    second = _attachment_points(end, target, children)
    if leaflets := match_leaflets(start, end, (first[0], second[0])):
        stalk = leaflets[0]
        # A leaflet that carries a child is a petiole, and petioles resemble each other.
        if np.isin(first, stalk.start).all() and np.isin(second, stalk.end).all():
            return None, leaflets
    motion = fit_motion(source, target, grows_at_base)
    whole = np.arange(len(start)), np.arange(len(end))
    return motion, (LeafletPair(*whole, motion.registered(start, end)),)


def _attachment_points(
    points: NDArray[np.floating], shape: OrganShape, children: Sequence[int]
) -> list[int]:
    """Indices of the points nearest to the attachment of an organ, and to those of its children."""
    places = [shape.attachment, *(shape.points[shape.nodes[child]] for child in children)]
    return [int(((points - place) ** 2).sum(axis=1).argmin()) for place in places]
