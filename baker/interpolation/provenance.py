"""What a clip says of itself: its organs as tracks, and where it came from."""

from collections.abc import Iterable, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from baker.alignment import Alignment
from baker.errors import InputError
from baker.interpolation.attributes import organ_colors
from baker.matching import Organ
from baker.matching.labels import LabelUse
from baker.options import Options
from baker.scans import Series
from baker.scans.formats import READERS, suffix_of
from baker.segmentation.hierarchy import Hierarchy
from gclip import Track
from gclip.version import __version__


def describe_tracks(series: Series, organs: Sequence[Organ], labels: LabelUse) -> tuple[Track, ...]:
    """The organs, the root first, as tracks: leaves go by the scans' labels, or as they appear."""
    by_label, scans = labels.are_names, series.scans
    times = [*(scan.time for scan in scans), None]
    is_stem = not (by_label and organs[0].label is None)  # what else is the root carries nothing

    def name(index: int, organ: Organ) -> str:
        if organ.label is not None and organ.label in labels.names:
            return labels.names[organ.label].name
        if by_label and organ.label in series.label_words:
            return series.label_words[organ.label]
        if index == 0:
            return "stem" if is_stem else "plant"
        return f"leaf {organ.label if by_label else index}"

    names = list(map(name, range(len(organs)), organs))
    called = set(zip(names, (organ.label for organ in organs), strict=True))
    for label, one in labels.names.items():
        if any(name == one.name and other != label for name, other in called):
            raise InputError(f"{one.said}: another organ is called '{one.name}', too.")
    return tuple(
        Track(
            id=index,
            name=names[index],
            color=color,
            parent=organ.parent,
            born=scans[organ.first].time,
            lost=times[organ.last + 1],
            kind="organ" if index else "stem" if is_stem else "root",
        )
        for index, (organ, color) in enumerate(zip(organs, organ_colors(len(organs)), strict=True))
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
