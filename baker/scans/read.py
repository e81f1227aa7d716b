"""From the paths a user gives to a series of clean scans: the one place where the steps meet."""

import hashlib
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, asking, excerpt
from baker.geometry.parallel import MapLike, ReportProgress, reporting
from baker.options import Options
from baker.scans.child_process import ChildProcess
from baker.scans.cloud import (
    Cloud,
    downsample,
    drop_duplicates,
    drop_non_finite,
    drop_outliers,
    own_origin,
    relative_to,
    resampled,
    shared_origin,
)
from baker.scans.fields import choose_fields
from baker.scans.find import find_scans
from baker.scans.formats import read_columns
from baker.scans.ground import take_out_ground
from baker.scans.labels import choose_labels, drop_labels
from baker.scans.rgbd.camera import find_camera
from baker.scans.rgbd.series import ImageSeries
from baker.scans.scan import Scan, Series
from baker.scans.size import require_one_unit
from baker.scans.times.schedule import Entry, Schedule, schedule_scans
from gclip.terminal.text import printable


def read_series(
    inputs: Sequence[Path],
    options: Options | None = None,
    report_progress: ReportProgress | None = None,
    map: MapLike = map,
    times: Sequence[object] | None = None,
) -> Series:
    """Read the scans of one plant, clean them and put them in the order of time.

    Parameters
    ----------
    inputs, options : sequence of Path, Options, optional
        One folder that holds one series, or two or more files; a folder with a camera's file holds
        colour and depth images (`baker.scans.rgbd`).
    report_progress : callable, optional
        Called at once and after each scan with the scans done and the scans in all.
    map : map-like callable, optional
        Maps a function over the scans.
    times : sequence, optional
        Of each scan the day or the date, instead of what the names say.

    Returns
    -------
    Series, whose scans share one `origin`, but for those too far from it

    Raises
    ------
    InputError, for everything that can't be read as one series
    """
    options = options or Options()
    listing = list_series(inputs, options, times)
    entries = listing.schedule.entries
    if report_progress:
        map = reporting(map, report_progress, len(entries))
    with ChildProcess() as child:
        read = partial(listing.read, options=options, child=child)
        raw, digests = zip(*map(read, entries), strict=True)
    shared = shared_origin(raw[0].points)
    origins = [own_origin(cloud.points, shared) for cloud in raw]
    clouds = list(map(drop_duplicates, map(relative_to, origins, raw)))
    paths, names = [entry.path for entry in entries], [printable(entry.name) for entry in entries]
    keep, is_asked = options.ground == "keep", options.label_field is not None
    are_needed = options.labels in ("consistent", "independent")
    clouds, field, words, labels = choose_labels(clouds, paths, is_asked, are_needed)
    clouds, dropped = drop_labels(clouds, paths, words, options.drop_label, keep)
    up = "z" if listing.images and options.up == "auto" else options.up
    files = [path.name for path in paths]
    clouds, ground_up, ground = take_out_ground(clouds, files, up, keep, map)
    clouds = _with_colors_in_all(list(map(partial(_thinned, options=options), clouds)), names)
    series = listing.series(tuple(map(_scan, entries, names, clouds, digests, origins)), options)
    unit = options.unit or series.length
    size = require_one_unit([cloud.points for cloud in clouds], names, unit)
    return replace(
        series,
        label_field=field,
        label_words=words,
        findings=(*series.findings, *labels, *dropped, *ground, size),
        ground_up=ground_up,
    )


def _thinned(cloud: Cloud, options: Options) -> Cloud:
    if options.outliers is not None:
        cloud = drop_outliers(cloud, options.outliers)
    if options.voxel is not None:
        cloud = downsample(cloud, options.voxel)
    return cloud if options.resample is None else resampled(cloud, options.resample)


def _with_colors_in_all(clouds: list[Cloud], names: list[str]) -> list[Cloud]:
    """Colours in all scans or in none."""
    without = [f"'{n}'" for n, cloud in zip(names, clouds, strict=True) if cloud.colors is None]
    if not without:
        return clouds
    note = f"colours left out ({excerpt(', '.join(without))} without colours)."
    return [
        cloud if cloud.colors is None else replace(cloud, colors=None).noting(note)
        for cloud in clouds
    ]


def _scan(entry: Entry, name: str, cloud: Cloud, sha256: str, origin: NDArray[np.float64]) -> Scan:
    time, date = entry.moment.time, entry.moment.date
    contents = cloud.points, cloud.labels, cloud.colors, date, cloud.notes, sha256, cloud.scalars
    return Scan(name, entry.path, time, origin, *contents)


@dataclass(frozen=True)
class Listing:
    """The scans of one plant, found, timed and ordered; nothing of them is read yet."""

    schedule: Schedule
    images: ImageSeries | None

    def files(self, entry: Entry) -> tuple[Path, ...]:
        """All files that one scan is made from."""
        return (entry.path, *(self.images.beside(entry.path) if self.images else ()))

    def read(
        self, entry: Entry, options: Options, child: ChildProcess | None = None
    ) -> tuple[Cloud, str]:
        """What a scan's files hold, but for points without a place, and their digest."""
        use_labels = options.labels != "ignore" or bool(options.drop_label)
        names, carried = (
            [*filter(None, listed.split(","))] for listed in (options.columns, options.fields)
        )

        def read() -> Cloud:
            if self.images:
                return self.images.read(entry.path, use_labels)
            columns = read_columns(entry.path, names, child)
            return choose_fields(columns, entry.path, options.label_field, use_labels, carried)

        cloud, sha256 = _read_unchanged(self.files(entry), read)
        scaled = replace(cloud, points=cloud.points * options.scale)
        return drop_non_finite(scaled, entry.path), sha256

    def series(self, scans: tuple[Scan, ...], options: Options) -> Series:
        """The series of these scans once they are read; without any, what is known of it before."""
        images, schedule = self.images, self.schedule
        has_virtual_root = images and images.has_labels and options.labels != "ignore"
        return Series(
            scans,
            schedule.unit,
            fixed=images is not None,
            root="virtual" if has_virtual_root else None,
            length="mm" if images else "",
            findings=(schedule.finding,),
        )


def list_series(
    inputs: Sequence[Path], options: Options, times: Sequence[object] | None = None
) -> Listing:
    """Find and time the scans that `read_series` would read, as it does; none is read yet."""
    camera = find_camera(inputs[0]) if len(inputs) == 1 else None
    if camera and options.label_field is not None:
        raise InputError(
            f"'{inputs[0]}' holds images, whose labels are images too, not a field: leave out "
            "--label-field."
        )
    file = options.times
    images = ImageSeries(camera, file) if camera else None
    schedule = images.schedule if images else schedule_scans(find_scans(inputs, file), file, times)
    kept, count = schedule.entries[:: options.every], len(schedule.entries)
    if len(kept) < 2:
        left = f"--every {options.every} leaves only the first one; growth needs at least two"
        raise InputError(f"of {count} scans, {left}.")
    if options.every > 1:
        found = f"{schedule.finding.found}; of {count} scans {len(kept)}, one in {options.every}"
        finding = replace(schedule.finding, found=found)
        schedule = replace(schedule, entries=kept, finding=finding)
    return Listing(schedule, images)


def digest(paths: Sequence[Path]) -> str:
    """SHA-256 over the bytes of all files a scan is read from. InputError for one unreadable."""
    found = hashlib.sha256()
    for path in paths:
        with asking(path), path.open("rb") as file:
            hashlib.file_digest(file, lambda: found)
    return found.hexdigest()


def _read_unchanged(paths: Sequence[Path], read: Callable[[], Cloud]) -> tuple[Cloud, str]:
    """What `read` makes of these files, and their digest.

    Raises InputError where they can't be read, or are not the same before and after.
    """
    before = _states(paths)
    try:
        with asking(paths[0]):
            return read(), digest(paths)
    finally:  # also after a fault, which may be only that
        if _states(paths) != before:
            changed = f"'{paths[0]}' changed while it was read; bake again when it is complete."
            raise InputError(changed) from None


def _states(paths: Sequence[Path]) -> list[tuple[int, ...]]:
    with asking(paths[0]):
        return [(s.st_dev, s.st_ino, s.st_size, s.st_mtime_ns) for s in map(os.stat, paths)]
