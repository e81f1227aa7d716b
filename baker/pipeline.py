"""From scans to a clip: the one place where the stages meet.

read -> align -> segment -> match -> transport -> pack
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.alignment import Alignment, align
from baker.alignment.stem_base import agreed_base_points, base_point
from baker.errors import InputError
from baker.geometry.neighbors import Neighbors, nearest_neighbors, point_area
from baker.geometry.parallel import MapLike, reporting, thread_map
from baker.geometry.up_axis import Vertical
from baker.interpolation.colors import painted
from baker.interpolation.interval_job import (
    InterpolationOptions,
    IntervalJob,
    IntervalSolver,
    solve_intervals,
)
from baker.interpolation.movers import Keyframe
from baker.interpolation.provenance import describe_provenance, describe_tracks
from baker.interpolation.smoothing import smooth_organs
from baker.interpolation.timing import Timing, organ_timings
from baker.matching import (
    IntervalOrgans,
    LabelUse,
    Match,
    follow_labels,
    follow_organs,
    label_policy,
    match_series,
)
from baker.options import Decay, Options, Paths, worker_count
from baker.recipe import Recipe, recipe_for
from baker.record import BakeRecord, HeldOut, left_out
from baker.scans import Series
from baker.scans.stage import read_scans, told_by
from baker.segmentation.hierarchy import Hierarchy
from baker.segmentation.label_cleaning import with_clean_labels
from baker.segmentation.organs import segment_organs
from baker.segmentation.stage import (
    coarse_hierarchies,
    labelled_hierarchies,
    thin_hierarchies,
    whole_hierarchies,
)
from baker.transport.tasks import interval_tasks
from baker.transport.wasserstein import wasserstein
from gclip import Clip, HeldOutScan, Motion, ScanMark

Progress = Callable[[str, int, int], None]
Register = Callable[..., Alignment]


def bake(
    paths: Sequence[str | Path], options: Options | None = None, progress: Progress | None = None
) -> Clip:
    """Bake scans into a growth clip.

    paths:    a folder of scans, or the scans' files.
    progress: called with a stage's name, the steps done and the steps in all.

    Raises InputError, with one sentence for the user, where the scans or options can't be baked.
    """
    return bake_recorded(paths, options, progress)[0]


def bake_recorded(
    paths: Sequence[str | Path],
    options: Options | None = None,
    progress: Progress | None = None,
    register: Register = align,
    solve: IntervalSolver | None = None,
) -> tuple[Clip, BakeRecord]:
    """Bake as `bake` does, and return what its stages found as well.

    Parameters
    ----------
    paths, options, progress
        As those of `bake`.
    register, solve
        As those of `bake_series`.

    Returns
    -------
    clip : Clip
    record : BakeRecord
        For the report and for verification.
    """
    chosen, progress = options or Options(), progress or _silent
    with thread_map(worker_count(chosen.workers)) as map:
        found = read_scans([Path(path) for path in paths], chosen, progress, map)
        return bake_series(found, chosen, progress, map, register, solve)


def bake_series(
    found: Series,
    options: Options,
    tell: Progress,
    map: MapLike = map,
    register: Register = align,
    solve: IntervalSolver | None = None,
) -> tuple[Clip, BakeRecord]:
    """Bake scans that have been read.

    Parameters
    ----------
    found : Series
    options : Options
    tell : callable
        Called with a stage's name, the steps done and the steps in all.
    map : MapLike
        Maps a function over scans.
    register : callable
        Aligns the scans as `baker.alignment.align` does; a cache may stand in for it.
    solve : IntervalSolver, optional
        Solves the intervals: a cache, or the workers of a cluster. By default threads.

    Returns
    -------
    As `bake_recorded`.
    """
    chosen = told_by(found, options)
    recipe = recipe_for(chosen)
    alignment = register(
        [scan.points for scan in found.scans],
        recipe.align,
        chosen.up,
        _local_root(found, chosen),
        progress=tell,
        map=map,
    )
    vertical = Vertical.named(alignment.up)
    series, keyframes, held_out = _hold_out(found, _keyframes(found, alignment), chosen.holdout)
    clouds = [frame.positions for frame in keyframes]
    root = _local_root(series, chosen)
    neighbors = list(map(nearest_neighbors, clouds))
    if not chosen.paper:
        pairs = zip(series.scans, neighbors, strict=True)
        series = replace(series, scans=tuple(with_clean_labels(*pair) for pair in pairs))
    bases = [
        base_point(cloud, vertical, root, near)
        for cloud, near in zip(clouds, neighbors, strict=True)
    ]
    if root is None and not chosen.paper:
        bases = agreed_base_points(clouds, bases, vertical)
    labels, hierarchies = _organs_of(series, clouds, bases, neighbors, recipe, chosen, tell, map)
    keyframes = painted(keyframes, series.scans, hierarchies, chosen.colors)
    matches = match_series(
        clouds,
        hierarchies,
        by_label=labels.consistent or recipe.whole,
        distance=wasserstein,
        rules=recipe.rules,
        report_progress=partial(tell, "matching"),
    )
    organs, named = follow_organs(matches, labels.consistent)
    jobs, spacing, floor = _interval_jobs(
        series,
        keyframes,
        neighbors,
        bases,
        matches,
        named,
        vertical,
        recipe,
        chosen,
        labels.found,
    )
    solve = solve or partial(solve_intervals, workers=worker_count(chosen.workers))
    intervals = tuple(solve(jobs, partial(tell, "transport")))
    origin = series.scans[0].origin
    clip = Clip(
        scans=tuple(ScanMark(s.name, s.time, s.date, len(s)) for s in series.scans),
        intervals=intervals,
        track_table=describe_tracks(series.scans, organs, labels),
        origin=(float(origin[0]), float(origin[1]), float(origin[2])),
        up=alignment.up,
        unit=chosen.unit,
        time_unit=series.unit,
        floor=floor,
        spacing=spacing,
        held_out=tuple(
            HeldOutScan(held.scan.name, held.scan.time, held.scan.date, held.keyframe.positions)
            for held in held_out
        ),
        provenance=describe_provenance(found, series, alignment, labels, hierarchies, chosen),
    )
    record = BakeRecord(
        found=found,
        series=series,
        keyframes=tuple(keyframes),
        alignment=alignment,
        labels=labels.sentence,
        hierarchies=tuple(hierarchies),
        matches=tuple(matches),
        organs=tuple(named),
        held_out=held_out,
        bud=(chosen.bud, recipe.min_attachment_points),
    )
    return clip, record


def _organs_of(
    series: Series,
    clouds: Sequence[NDArray[np.float32]],
    bases: Sequence[int],
    neighbors: Sequence[Neighbors],
    recipe: Recipe,
    options: Options,
    tell: Progress,
    map: MapLike,
) -> tuple[LabelUse, list[Hierarchy]]:
    """How labels are used, and each scan's hierarchy, under labels that name the same organs."""
    ignored = recipe.whole or options.segment != "auto"
    labels = label_policy(
        [scan.labels for scan in series.scans],
        [scan.name for scan in series.scans],
        clouds,
        bases,
        "ignore" if ignored else options.labels,
    )
    if recipe.segment == "whole":
        return labels, whole_hierarchies(clouds)
    map = reporting(map, partial(tell, "segmentation"), len(clouds))
    if labels.labels is None and recipe.segment == "thin":
        k, threshold = options.graph_neighbors, options.bifurcation
        return labels, thin_hierarchies(clouds, bases, neighbors, k, threshold, map)
    if labels.labels is None or (recipe.match_by_shape and not labels.consistent):
        own = labels.labels or segment_organs(clouds, bases, map)
        labels = follow_labels(labels, clouds, coarse_hierarchies(clouds, own, bases), bases)
    assert labels.labels is not None
    return labels, labelled_hierarchies(
        clouds,
        labels.labels,
        bases,
        neighbors,
        consistent=labels.consistent,
        agreeing=recipe.match_by_shape,
        virtual_root=options.root == "virtual",
        map=map,
    )


def _silent(stage: str, done: int, total: int) -> None:
    """Nobody watches."""


def _local_root(series: Series, options: Options) -> NDArray[np.float64] | None:
    if options.root is None or options.root == "virtual":
        return None
    return np.asarray(options.root, float) - series.scans[0].origin


def _keyframes(series: Series, alignment: Alignment) -> list[Keyframe]:
    keyframes = []
    for scan, transform in zip(series.scans, alignment.transforms, strict=True):
        positions = scan.points
        if not np.array_equal(transform, np.eye(4)):
            turned = scan.points @ transform[:3, :3].T + transform[:3, 3]
            positions = turned.astype(np.float32)
        opaque = np.full((len(scan), 1), 255, np.uint8)
        colors = None if scan.colors is None else np.hstack([scan.colors, opaque])
        keyframes.append(Keyframe(positions, colors))
    return keyframes


def _hold_out(
    found: Series, keyframes: Sequence[Keyframe], every: int | None
) -> tuple[Series, list[Keyframe], tuple[HeldOut, ...]]:
    """Part an aligned series into what is baked and what is left out for verification."""
    if every is not None and every < 2:
        raise InputError(f"--holdout is {every}; 2 or more is needed: 2 leaves every second out.")
    numbers = left_out(len(found.scans), every)
    if every is not None and not numbers:
        raise InputError(
            f"--holdout {every} leaves none of the {len(found.scans)} scans out; "
            f"at least {every + 1} are needed, for the first and the last always stay."
        )
    kept = [k for k in range(len(found.scans)) if k not in numbers]
    return (
        replace(found, scans=tuple(found.scans[k] for k in kept)),
        [keyframes[k] for k in kept],
        tuple(HeldOut(found.scans[k], keyframes[k]) for k in numbers),
    )


def _interval_jobs(
    series: Series,
    keyframes: Sequence[Keyframe],
    neighbors: Sequence[Neighbors],
    bases: Sequence[int],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    vertical: Vertical,
    recipe: Recipe,
    options: Options,
    found: bool,
) -> tuple[list[IntervalJob], float, float]:
    """What each interval is worked out from, and the series' point spacing and floor.

    Here everything is settled that spans intervals: spacing, floor, smoothed organs, the
    timing of growth.

    found: whether the organs were segmented by the program. Some of what is lost then is a piece of
           a leaf that the next scan counts to its leaf: nothing has fallen, so it fades.
    """
    decay = Motion.FADE if found and options.decay == Decay.fall else Motion(options.decay)
    spacings = [near.spacing for near in neighbors]
    spacing = float(np.median(spacings))
    floor = min(float(vertical.height(frame.positions).min()) for frame in keyframes)
    feet = [frame.positions[base] for frame, base in zip(keyframes, bases, strict=True)]
    times = [scan.time for scan in series.scans]
    if options.smooth:
        keyframes = smooth_organs(keyframes, matches, organs, times)
    if recipe.even:
        keyframes = [
            replace(frame, area=point_area(frame.positions, near))
            for frame, near in zip(keyframes, neighbors, strict=True)
        ]
    clouds = [frame.positions for frame in keyframes]
    timings: list[dict[int, Timing]] = [{} for _ in matches]
    if recipe.paths == Paths.curved:
        timings = organ_timings(clouds, matches, organs, times, spacing)
    tasks = [
        tuple(
            interval_tasks(
                (clouds[k], clouds[k + 1]),
                match,
                organs[k],
                options.bud,
                recipe.min_attachment_points,
            )
        )
        for k, match in enumerate(matches)
    ]
    chosen = InterpolationOptions(
        transport=recipe.transport,
        leaflets=recipe.leaflets,
        decay=decay,
        curved=recipe.paths == Paths.curved,
        even=recipe.even,
        precision=options.precision,
    )
    jobs = [
        IntervalJob(
            times=(times[k], times[k + 1]),
            start=keyframes[k],
            end=keyframes[k + 1],
            match=match,
            organs=organs[k],
            bases=(feet[k], feet[k + 1]),
            tasks=tasks[k],
            timings=timings[k],
            vertical=vertical,
            floor=floor if any(task.event == "loss" for task in tasks[k]) else 0.0,
            spacing=(spacings[k] + spacings[k + 1]) / 2,
            options=chosen,
        )
        for k, match in enumerate(matches)
    ]
    return jobs, spacing, floor
