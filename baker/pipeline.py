"""Bake scans into a clip: all stages, in the order of the paper's sections.

Each stage passes its result on to the next; no stage calls another one.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise, repeat
from pathlib import Path

import numpy as np

from baker.alignment.keyframes import AlignedSeries, aligned_keyframes, hold_out
from baker.alignment.register import Alignment, align
from baker.alignment.stem_base import base_point, named_base
from baker.geometry.neighbors import nearest_neighbors
from baker.geometry.parallel import MapLike, one_blas_thread, reporting, thread_map, worker_count
from baker.geometry.surface import normals_and_areas
from baker.geometry.up_axis import Vertical
from baker.interpolation.attributes import with_colors, with_fields
from baker.interpolation.interval_job import interval_jobs, solve_intervals
from baker.interpolation.primordia import with_primordia
from baker.interpolation.provenance import describe_provenance, describe_tracks
from baker.matching.corrections import (
    PointCorrection,
    confirmed_organs,
    corrections_finding,
    locate_corrections,
    organ_names,
    with_corrected_links,
    with_corrected_organs,
)
from baker.matching.labels import LabelUse, label_policy, with_tracked_labels
from baker.matching.match import chain_matches, match_series
from baker.options import Options
from baker.scans.read import read_series
from baker.scans.scan import Finding, Series
from baker.scans.size import points_finding
from baker.segmentation.from_labels import hierarchy_from_labels, labelled_hierarchies
from baker.segmentation.from_spanning_tree import hierarchy_from_spanning_tree
from baker.segmentation.hierarchy import Hierarchy
from baker.segmentation.label_cleaning import with_clean_labels
from baker.segmentation.organs import find_organs
from baker.transport.solve import wasserstein
from baker.transport.tasks import interval_tasks
from baker.verdict.judge import judge_clip
from gclip import Clip, Interval, ScanMark

Progress = Callable[[str, int, int], None]
"""``progress(stage, done, total)``"""


@dataclass(frozen=True)
class Survey:
    """A series before segmentation: its scans in one frame, and the decisions about them."""

    raw: Series  # all scans as they were read, including those left out
    series: Series  # the scans to bake
    options: Options  # completed by `Options.for_series`
    alignment: Alignment  # of all raw scans
    aligned: AlignedSeries
    held_out: tuple[ScanMark, ...]
    labels: LabelUse
    corrections: tuple[PointCorrection, ...]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The decisions about the series, with the doubts about them."""
        points = points_finding(self.series.scans)
        stages = (self.raw, self.alignment, self.labels)
        return (points, *(finding for stage in stages for finding in stage.findings))


@one_blas_thread()
def bake_with_survey(
    paths: Sequence[str | Path],
    options: Options | None = None,
    progress: Progress | None = None,
    solve: Callable[..., Iterable[Interval]] | None = None,
    times: Sequence[object] | None = None,
    report_findings: Callable[[Sequence[Finding]], None] | None = None,
) -> tuple[Clip, Survey]:
    """Bake scans into a growth clip; also return the aligned series and the findings about it.

    paths, options, progress, times: as in `baker.bake`. solve: `solve_intervals`, or a function
    like it that has a cache. report_findings: called with the findings about the series before
    segmentation begins. Raises InputError if the scans or options can't be baked.
    """
    options, progress = options or Options(), progress or (lambda stage, done, total: None)
    workers = worker_count(options.workers)
    # These threads end before the next ones begin, so that the allocator reuses their memory.
    with thread_map(workers) as map:
        # Reading and alignment (section 3.1)
        survey = survey_series(paths, options, progress, map, times)
        if report_findings:
            report_findings(survey.findings)
        series, aligned, options = survey.series, survey.aligned, survey.options
        choices = options.resolved()

        # Segmentation (3.2); without consistent labels, organs are tracked over the series (3.3)
        labels, hierarchies = _segment(survey, choices, progress, map)
    keyframes = with_colors(aligned.keyframes, series.scans, hierarchies, options.colors)
    # Later stages need the point spacing only; the other neighbours are not kept in memory.
    nearest = tuple(neighbors.first(1) for neighbors in aligned.neighbors)
    aligned = replace(aligned, keyframes=tuple(keyframes), neighbors=nearest)
    survey = replace(survey, aligned=aligned)

    # Matching (3.3)
    matches = match_series(
        aligned.clouds,
        hierarchies,
        by_label=labels.consistent or choices.whole,
        distance=wasserstein,
        report_progress=partial(progress, "matching"),
    )
    organs, matches = chain_matches(matches, labels.consistent)

    if not (choices.paper or choices.whole):
        matches = with_primordia(aligned, matches)

    # Transport (3.4) and interpolation, interval by interval
    intervals = zip(pairwise(aligned.clouds), matches, strict=True)
    tasks = [interval_tasks(*interval, choices.bud, choices.paper) for interval in intervals]
    jobs = interval_jobs(aligned, matches, tasks, choices, unlabelled=labels.unlabelled)
    solved = tuple((solve or solve_intervals)(jobs, partial(progress, "transport"), workers))
    clip = Clip(
        scans=tuple(ScanMark(s.name, s.time, s.date, len(s)) for s in series.scans),
        intervals=solved,
        track_table=describe_tracks(series, organs, labels),
        origin=tuple(survey.raw.scans[0].origin.tolist()),
        up=survey.alignment.up,
        unit=options.unit,
        time_unit=series.unit,
        floor=aligned.floor,
        spacing=aligned.spacing,
        held_out=survey.held_out,
        provenance=describe_provenance(
            survey.raw, series, survey.alignment, labels, hierarchies, options
        ),
    )
    confirmed = confirmed_organs(labels.available, survey.corrections)
    with thread_map(workers) as map:
        clip = judge_clip(clip, jobs, labels, confirmed, map)
    return with_fields(clip, aligned.clouds, series.scans), survey


def survey_series(
    paths: Sequence[str | Path],
    options: Options,
    progress: Progress,
    map: MapLike,
    times: Sequence[object] | None = None,
) -> Survey:
    """Read scans, align them and decide what their labels mean (section 3.1).

    paths, options, progress, times: as in `bake_with_survey`. map: maps over the scans.
    """
    files = [Path(path) for path in paths]
    raw = read_series(files, options, partial(progress, "reading"), map, times)
    options = options.for_series(raw.fixed, raw.length, raw.root)
    choices, root = options.resolved(), None
    if isinstance(options.root, tuple):
        root = named_base(options.root, raw.scans[0])
    alignment = align(raw, choices.align, choices.up, root, progress, map)
    series, frames, held_out = hold_out(raw, aligned_keyframes(raw, alignment), options.holdout)

    # Neighbours are found for one scan after another, each in parallel, since scans differ in size.
    clouds, vertical = [frame.positions for frame in frames], Vertical.named(alignment.up)
    neighbors = [nearest_neighbors(cloud, map=map) for cloud in clouds]
    # The threads begin with the labels and bases of whole scans, then share the surfaces of each.
    scans = series.scans if options.paper else map(with_clean_labels, series.scans, neighbors)
    is_estimated = root is None and not options.paper
    positions = [frame.base if is_estimated else root for frame in frames]
    bases = map(base_point, clouds, repeat(vertical), neighbors, positions)
    surfaces = [normals_and_areas(*pair, map) for pair in zip(clouds, neighbors, strict=True)]
    series = replace(series, scans=tuple(scans))
    keyframes = tuple(
        replace(frame, normals=normals, area=area if choices.even else None)
        for frame, (normals, area) in zip(frames, surfaces, strict=True)
    )
    days = tuple(scan.time for scan in series.scans)
    aligned = AlignedSeries(days, keyframes, tuple(neighbors), tuple(bases), vertical)

    labels = label_policy(series, aligned.clouds, aligned.bases, choices.labels)
    corrections = options.corrections or ()
    if corrections:
        labels = replace(labels, findings=(*labels.findings, corrections_finding(corrections)))
    located = locate_corrections(corrections, raw, series, aligned, options.scale)
    return Survey(raw, series, options, alignment, aligned, held_out, labels, located)


def _segment(
    survey: Survey, options: Options, progress: Progress, map: MapLike
) -> tuple[LabelUse, list[Hierarchy]]:
    """Segment each scan into a hierarchy; also return its labels, tracked over the series."""
    labels, aligned, corrections = survey.labels, survey.aligned, survey.corrections
    clouds, bases = aligned.clouds, aligned.bases
    if options.whole:
        one_organ = [np.zeros(len(cloud), np.int64) for cloud in clouds]
        return labels, [hierarchy_from_labels(organ, 0, gaps={}) for organ in one_organ]
    map = reporting(map, partial(progress, "segmentation"), len(clouds))
    organs = labels.available
    if not organs and options.segment == "thin":
        k, threshold = repeat(options.graph_neighbors), repeat(options.bifurcation)
        scans = clouds, bases, aligned.neighbors
        return labels, list(map(hierarchy_from_spanning_tree, *scans, k, threshold))
    is_complete = len(organs) == len(clouds)
    if not is_complete:
        pairs = zip(labels.labels, map(find_organs, clouds, bases), strict=True)
        organs = [by_shape if known is None else known for known, by_shape in pairs]
    organs = with_corrected_organs(organs, aligned, corrections)
    if not is_complete or not (labels.consistent or options.paper):
        labels = with_tracked_labels(labels, clouds, organs, bases, corrections)
        organs = labels.available
    organs = with_corrected_links(organs, corrections)
    labels = replace(labels, labels=tuple(organs), names=organ_names(organs, corrections))
    return labels, labelled_hierarchies(
        clouds,
        organs,
        bases,
        aligned.neighbors,
        consistent=labels.consistent,
        same_parents=not options.paper,
        found=labels.unlabelled,
        virtual_root=options.root == "virtual",
        map=map,
    )
