"""From the paths a user gives to a series of clean scans: the one place where the steps meet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, repeat
from math import isfinite
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.geometry.parallel import MapLike
from baker.options import Options
from baker.scans import clean, place
from baker.scans.cloud import Cloud
from baker.scans.denoise import denoised
from baker.scans.fields import choose_fields
from baker.scans.find import find_scans
from baker.scans.formats import read_columns, suffix_of
from baker.scans.rgbd.camera import find_camera
from baker.scans.rgbd.series import ImageSeries
from baker.scans.scan import Scan, Series
from baker.scans.times import Entry, Schedule, schedule_scans
from baker.scans.unchanged import read_unchanged
from gclip.terminal.text import printable

Progress = Callable[[int, int, str], None]
"""Called before each scan is read and once at the end: scans done, scans in all, what is next."""

MIN_VALUES = {"denoise": 4, "resample": 10}


@dataclass(frozen=True)
class ReadOptions:
    """How scans are read.

    label_field:  the field that holds the labels; None looks for the usual names
                  (`baker.scans.fields.LABEL_NAMES`).
    use_labels:   False reads the scans as if they had no labels.
    times_file:   a text file with a line `name time` for each scan; before times in file names.
    outliers:     None keeps all points; a number r drops those whose mean distance to their 16
                  nearest neighbours is more than r standard deviations above the scan's average
                  (2 is usual, smaller drops more).
    voxel:        None keeps all points; a length (unit of the scans) keeps one point for each cube
                  of that size and label.
    denoise:      None leaves points where they are; a number k draws each onto a plane through its
                  k nearest neighbours.
    resample:     None keeps all points; a number keeps about as many of each scan, evenly spread.
    every:        1 reads all scans; n only the first and then each n-th, in the order of time.
    """

    label_field: str | None = None
    use_labels: bool = True
    times_file: Path | None = None
    outliers: float | None = None
    voxel: float | None = None
    denoise: int | None = None
    resample: int | None = None
    every: int = 1

    @classmethod
    def of(cls, options: Options) -> ReadOptions:
        """Those of a bake with these options."""
        return cls(
            label_field=options.label_field,
            use_labels=options.labels != "ignore",
            times_file=options.times,
            outliers=options.outliers,
            voxel=options.voxel,
            denoise=options.denoise,
            resample=options.resample,
            every=options.every,
        )

    def __post_init__(self) -> None:
        for name, value in (("outliers", self.outliers), ("voxel", self.voxel)):
            if value is not None and not (isfinite(value) and value > 0):
                raise InputError(f"{name} must be a number above 0, not {value}.")
        for name, number in (("denoise", self.denoise), ("resample", self.resample)):
            if number is not None and number < MIN_VALUES[name]:
                raise InputError(f"{name} must be {MIN_VALUES[name]} or more, not {number}.")
        if self.every < 1:
            raise InputError(f"every must be a whole number, 1 or more, not {self.every}.")


def read_series(
    inputs: Sequence[Path],
    options: ReadOptions | None = None,
    progress: Progress | None = None,
    map: MapLike = map,
) -> Series:
    """Read the scans of one plant, clean them and put them in the order of time.

    Parameters
    ----------
    inputs : sequence of Path
        One folder that holds one series, or two or more files; a folder with a camera's file holds
        colour and depth images (`baker.scans.rgbd`).
    options : ReadOptions, optional
        How scans are read.
    progress : callable, optional
        Called with the scans done, the scans in all and the name of the next one.
    map : map-like callable, optional
        Maps a function over the scans.

    Returns
    -------
    Series
        All scans share one `origin`, chosen from the first one (`baker.scans.place.shared_origin`).

    Raises
    ------
    InputError
        For everything that can't be read as one series: see the modules `find`, `times`,
        `formats`, `fields` and `clean` for each step's own rules.
    """
    options = options or ReadOptions()
    listing = list_series(inputs, options)
    entries = listing.schedule.entries
    report_progress = progress or (lambda done, total, name: None)
    report_progress(0, len(entries), entries[0].name)
    raw = _raw(entries[0], listing, options)
    origin = place.shared_origin(clean.drop_non_finite(raw[0], entries[0].path).points)
    read = partial(_scan, origin=origin, listing=listing, options=options)
    scans: list[Scan] = []
    for scan in map(read, entries, chain([raw], repeat(None))):
        scans.append(scan)
        name = entries[len(scans)].name if len(scans) < len(entries) else ""
        report_progress(len(scans), len(entries), name)
    return listing.series(_agree(scans, options), options)


def _raw(entry: Entry, listing: Listing, options: ReadOptions) -> tuple[Cloud, str]:
    """What a scan's files hold, and their digest."""
    return read_unchanged(listing.files(entry), partial(_read, entry.path, listing.images, options))


def _scan(
    entry: Entry,
    raw: tuple[Cloud, str] | None,
    *,
    origin: NDArray[np.float64],
    listing: Listing,
    options: ReadOptions,
) -> Scan:
    """One scan, clean, about the series' origin: from its files, or `raw` if they are read."""
    cloud, sha256 = raw or _raw(entry, listing, options)
    cloud = clean.drop_non_finite(cloud, entry.path)
    clean.require_size(cloud, entry.path)
    cloud = clean.drop_duplicates(place.relative_to(origin, cloud))
    if options.outliers is not None:
        cloud = clean.drop_outliers(cloud, options.outliers)
    if options.voxel is not None:
        cloud = clean.downsample(cloud, options.voxel)
    if options.denoise is not None:
        cloud = denoised(cloud, options.denoise)
    if options.resample is not None:
        cloud = clean.resampled(cloud, options.resample)
    return Scan(
        name=printable(entry.name),
        path=entry.path,
        time=entry.moment.time,
        origin=origin,
        points=cloud.points,
        labels=cloud.labels,
        colors=cloud.colors,
        date=entry.moment.date,
        notes=cloud.notes,
        beside=listing.files(entry)[1:],
        sha256=sha256,
    )


@dataclass(frozen=True)
class Listing:
    """The scans of one plant, found, timed and ordered; nothing of them is read yet."""

    schedule: Schedule
    images: ImageSeries | None

    def files(self, entry: Entry) -> tuple[Path, ...]:
        """All files that one scan is made from."""
        return (entry.path, *(self.images.beside(entry.path) if self.images else ()))

    def series(self, scans: tuple[Scan, ...], options: ReadOptions) -> Series:
        """The series of these scans once they are read; without any, what is known of it before."""
        images = self.images
        return Series(
            scans,
            self.schedule.rule,
            self.schedule.unit,
            fixed=images is not None,
            length="mm" if images else "",
            root="virtual" if images and images.has_labels and options.use_labels else None,
        )


def list_series(inputs: Sequence[Path], options: ReadOptions) -> Listing:
    """What `read_series` would read. Raises InputError as that does."""
    images = _open_images(inputs, options)
    if images:
        schedule = images.schedule
    else:
        schedule = schedule_scans(find_scans(inputs, options.times_file), options.times_file)
    return Listing(_thin_out(schedule, options.every), images)


def _open_images(inputs: Sequence[Path], options: ReadOptions) -> ImageSeries | None:
    """The series of images in the one folder given, or None where there is none."""
    camera = find_camera(inputs[0]) if len(inputs) == 1 else None
    if camera is None:
        return None
    if options.label_field is not None:
        raise InputError(
            f"'{inputs[0]}' holds images, whose labels are images too, not a field: leave out "
            "--label-field."
        )
    return ImageSeries(camera, options.times_file)


def _thin_out(schedule: Schedule, every: int) -> Schedule:
    if every == 1:
        return schedule
    kept = schedule.entries[::every]
    count = len(schedule.entries)
    if len(kept) < 2:
        raise InputError(
            f"of {count} scans, --every {every} leaves only the first one; growth needs at least "
            "two."
        )
    rule = f"{schedule.rule} Of {count} scans {len(kept)} are used, one in {every}."
    return replace(schedule, entries=kept, rule=rule)


def _read(path: Path, images: ImageSeries | None, options: ReadOptions) -> Cloud:
    return images.read(path, options.use_labels) if images else _load(path, options)


def _load(path: Path, options: ReadOptions) -> Cloud:
    return choose_fields(read_columns(path), path, options.label_field, options.use_labels)


def _agree(scans: list[Scan], options: ReadOptions) -> tuple[Scan, ...]:
    """Labels in all scans or in none (else an error); colours in all or in none (else dropped)."""
    if options.label_field is None and _never_classified(scans):
        scans = [_without(scan, "labels", "classification is 0 everywhere") for scan in scans]

    unlabelled = [scan.name for scan in scans if scan.labels is None]
    if 0 < len(unlabelled) < len(scans):
        raise InputError(
            f"{_list_names(unlabelled)} of the {len(scans)} scans: no labels found, while the "
            "others have labels; add them, name their field with --label-field, or read all scans "
            "without labels (--labels ignore)."
        )

    colorless = [scan.name for scan in scans if scan.colors is None]
    if 0 < len(colorless) < len(scans):
        reason = f"{_list_names(colorless)} without colours"
        scans = [
            _without(scan, "colors", reason) if scan.colors is not None else scan for scan in scans
        ]
    return tuple(scans)


def _never_classified(scans: Sequence[Scan]) -> bool:
    """Whether all scans are LAS whose labels, the classification, are 0 throughout."""
    return all(
        suffix_of(scan.path) in (".las", ".laz")
        and scan.labels is not None
        and not scan.labels.any()
        for scan in scans
    )


def _without(scan: Scan, what: str, reason: str) -> Scan:
    note = f"{'colours' if what == 'colors' else what} left out ({reason})."
    notes = (*scan.notes, note)
    if what == "colors":
        return replace(scan, colors=None, notes=notes)
    return replace(scan, labels=None, notes=notes)


def _list_names(names: Sequence[str]) -> str:
    quoted = [f"'{name}'" for name in names]
    if len(quoted) > 4:
        quoted = [*quoted[:3], f"{len(quoted) - 3} more"]
    return ", ".join(quoted)
