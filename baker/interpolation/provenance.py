"""Describe a clip: its organs as tracks, and its provenance."""

from collections.abc import Iterable, Sequence
from importlib.metadata import distributions
from itertools import chain
from pathlib import Path
from typing import Any

from baker.alignment.register import Alignment
from baker.errors import InputError
from baker.interpolation.attributes import organ_colors
from baker.matching.labels import LabelUse
from baker.matching.match import Organ
from baker.options import Options
from baker.scans.formats import READERS, suffix_of
from baker.scans.scan import Series
from baker.segmentation.hierarchy import Hierarchy
from gclip import Track, __version__

PACKAGES = ("numpy", "scipy", "numba")  # on which the numbers in every clip depend


def describe_tracks(series: Series, organs: Sequence[Organ], labels: LabelUse) -> tuple[Track, ...]:
    """Make the tracks of a clip, named by corrections, by the labels of the scans, or by number.

    series: the scans that were baked. organs: the root first. Raises InputError if a correction
    gives an organ the name of another one.
    """
    by_label, scans = labels.are_names, series.scans
    times = [*(scan.time for scan in scans), None]
    is_stem = not (by_label and organs[0].label is None)  # else the root is virtual

    def name(index: int, organ: Organ) -> str:
        if organ.label is not None and organ.label in labels.names:
            return labels.names[organ.label].name
        if by_label and organ.label in series.label_words:
            return series.label_words[organ.label]
        if index == 0:
            return "stem" if is_stem else "plant"
        return f"leaf {organ.label if by_label else index}"

    names = list(map(name, range(len(organs)), organs))
    for label, correction in labels.names.items():
        others = [name for name, organ in zip(names, organs, strict=True) if organ.label != label]
        if correction.name in others:
            raise InputError(
                f"{correction.title}: another organ is called '{correction.name}', too."
            )
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
    """The provenance of a clip: everything needed to bake it again (docs/format.md).

    raw, series: all scans as they were read, and the scans that were baked. alignment: of all
    scans. labels, hierarchies: of those that were baked. options: as the user gave them.
    """
    baked_times = {scan.time for scan in series.scans}
    left_out = [scan.name for scan in raw.scans if scan.time not in baked_times]
    notes = [f"left out of the bake, only aligned: {', '.join(left_out)}"] if left_out else []
    for scan, hierarchy in zip(series.scans, hierarchies, strict=True):
        notes += [f"{scan.name}: {note}" for note in (*scan.notes, *hierarchy.notes)]
    findings = (*series.findings, *alignment.findings, *labels.findings)
    return {
        **software((scan.path for scan in raw.scans), options.outliers),
        "options": options.provenance(),
        "inputs": [{"name": scan.name, "sha256": scan.sha256} for scan in raw.scans],
        "origins": [scan.origin.tolist() for scan in raw.scans],
        "transforms": alignment.transforms.tolist(),
        "decisions": [finding.sentence for finding in findings],
        "notes": notes,
    }


def software(
    scans: Iterable[Path] = (), outliers: float | None = None
) -> dict[str, dict[str, str]]:
    """Versions of the program, and of the packages on which the numbers in a clip depend.

    Open3D is one of these packages if a scan is a mesh, or `outliers`, the option, is given.
    """
    is_mesh = any(READERS.get(suffix_of(path)) == "mesh" for path in scans)
    open3d = ("open3d", "open3d-cpu") if is_mesh or outliers is not None else ()
    installed = chain.from_iterable(distributions(name=name) for name in (*PACKAGES, *open3d))
    packages = {package.name.removesuffix("-cpu"): package.version for package in installed}
    return {"program": {"name": "plant-growth-clips", "version": __version__}, "packages": packages}
