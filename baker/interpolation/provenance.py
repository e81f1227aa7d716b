"""What a clip says of itself: its organs as tracks, and where it came from."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from baker.alignment import Alignment
from baker.interpolation.colors import organ_colors
from baker.interpolation.own_numbers import renumbered
from baker.matching import Organ
from baker.matching.labels import LabelUse
from baker.options import Options
from baker.scans import Series
from baker.scans.formats import READERS, suffix_of
from baker.segmentation.hierarchy import Hierarchy
from gclip import Clip, Track
from gclip.version import __version__


def organ_order(organs: Sequence[Organ], heights: Mapping[int, float]) -> list[int]:
    """The organs, the root first, as they appear; those of one scan from the lowest on.

    heights: by organ the height of its attachment in the scan in which it appears, where that is
    known and labels don't say which organ is which.
    """
    leaves = range(1, len(organs))
    return [0, *sorted(leaves, key=lambda i: (organs[i].first, heights.get(i, np.inf), i))]


def describe_tracks(
    series: Series, organs: Sequence[Organ], labels: LabelUse, order: Sequence[int]
) -> tuple[Track, ...]:
    """The organs as tracks: the stem, and leaves by the scans' labels or by order of appearance.

    Parameters
    ----------
    series : Series
    organs : sequence of Organ
        The root first.
    labels : LabelUse
        Whether labels are the scans' own.
    order : sequence of int
        The organs' `organ_order`, by which leaves are numbered and get their colours.

    Returns
    -------
    tuple of gclip.Track
    """
    by_label, scans = labels.are_names, series.scans
    times = [*(scan.time for scan in scans), None]
    numbers, colors = np.argsort(order), organ_colors(len(organs))

    is_stem = not (by_label and organs[0].label is None)  # what else is the root carries nothing

    def name(index: int, organ: Organ) -> str:
        if organ.label is not None and organ.label in labels.names:
            return labels.names[organ.label]
        if by_label and organ.label in series.label_words:
            return series.label_words[organ.label]
        if index == 0:
            return "stem" if is_stem else "plant"
        return f"leaf {organ.label if by_label else numbers[index]}"

    return tuple(
        Track(
            id=index,
            name=name(index, organ),
            color=colors[numbers[index]],
            parent=organ.parent,
            born=scans[organ.first].time,
            lost=times[organ.last + 1],
            kind="organ" if index else "stem" if is_stem else "root",
        )
        for index, organ in enumerate(organs)
    )


def in_order(clip: Clip, order: Sequence[int]) -> Clip:
    """The clip with its tracks in another order: `order` has their present ids."""
    rank = np.argsort(order)
    tracks = [clip.track_table[old] for old in order]
    parents = [None if t.parent is None else int(rank[t.parent]) for t in tracks]
    verdict = clip.provenance["verdict"]
    doubts = [doubt | {"track": int(rank[doubt["track"]])} for doubt in verdict["doubts"]]
    return replace(
        clip,
        track_table=tuple(
            replace(track, id=new, parent=parent)
            for new, (track, parent) in enumerate(zip(tracks, parents, strict=True))
        ),
        intervals=tuple(renumbered(interval, rank) for interval in clip.intervals),
        provenance=clip.provenance | {"verdict": verdict | {"doubts": doubts}},
    )


def describe_provenance(
    raw: Series,
    series: Series,
    alignment: Alignment,
    labels: LabelUse,
    hierarchies: Sequence[Hierarchy],
    options: Options,
) -> dict[str, Any]:
    """What made a clip: enough to bake it again and to see that it is the same.

    Parameters
    ----------
    raw : Series
        All scans as they were read.
    series : Series
        The scans that were baked.
    alignment : Alignment
        Of all raw scans.
    labels : LabelUse
    hierarchies : sequence of Hierarchy
    options : Options
        As they were requested.

    Returns
    -------
    dict
        What JSON can hold.
    """
    notes: list[str] = []
    if len(series.scans) < len(raw.scans):
        kept = {scan.time for scan in series.scans}
        names = [scan.name for scan in raw.scans if scan.time not in kept]
        notes.append(f"left out of the bake, only aligned: {', '.join(names)}")
    for scan, hierarchy in zip(series.scans, hierarchies, strict=True):
        notes += [f"{scan.name}: {note}" for note in (*scan.notes, *hierarchy.notes)]
    findings = (*series.findings, *alignment.findings, *labels.findings)
    return {
        **software((scan.path for scan in raw.scans), options.outliers),
        "options": options.provenance(),
        "inputs": [{"name": scan.name, "sha256": scan.sha256} for scan in raw.scans],
        "origins": [scan.origin.tolist() for scan in raw.scans],
        "transforms": [transform.tolist() for transform in alignment.transforms],
        "decisions": [finding.sentence for finding in findings],
        "notes": notes,
    }


def software(
    scans: Iterable[Path] = (), outliers: float | None = None
) -> dict[str, dict[str, str]]:
    """Versions of the program and of the packages that a clip's numbers come from.

    Open3D is named where one of the scans is a mesh, or where it removes outliers.
    """
    packages = {name: version(name) for name in ("numpy", "scipy", "numba")}
    if outliers is not None or any(READERS.get(suffix_of(path)) == "mesh" for path in scans):
        try:
            packages["open3d"] = version("open3d")
        except PackageNotFoundError:
            packages["open3d"] = version("open3d-cpu")
    program = {"name": "plant-growth-clips", "version": __version__}
    return {"program": program, "packages": packages}
