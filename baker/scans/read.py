"""Read the scans of one plant from files, clean them, and order them by time."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from baker.errors import InputError, excerpt, input_errors
from baker.geometry.parallel import MapLike, ReportProgress, reporting
from baker.options import Options
from baker.scans import cleaning
from baker.scans.child_process import ChildProcess
from baker.scans.fields import choose_fields
from baker.scans.find import find_scans
from baker.scans.formats import read_columns
from baker.scans.ground import remove_ground
from baker.scans.labels import choose_labels, drop_labels
from baker.scans.rgbd.camera import find_camera
from baker.scans.rgbd.series import ImageSeries
from baker.scans.scan import Scan, Series
from baker.scans.size import require_one_unit
from baker.scans.times.schedule import schedule_scans


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
    inputs : sequence of Path
        One folder that holds one series, or two or more files. A folder with a camera file holds
        colour and depth images (`baker.scans.rgbd`).
    options : Options, optional
    report_progress : callable, optional
        Called before the first scan and after each one with the number done and the total.
    map : map-like callable, optional
        Maps over the scans.
    times : sequence, optional
        The day or date of each scan; by default they are read from the names.

    Returns
    -------
    Series

    Raises
    ------
    InputError
        If the inputs can't be read as one series.
    """
    options = options or Options()
    listing = list_series(inputs, options, times)
    series = listing.series
    resolved = options.for_series(series.fixed, series.length, series.root)
    if report_progress:
        map = reporting(map, report_progress, len(series.scans))
    with ChildProcess() as child:
        scans = list(map(partial(listing.read, options=options, child=child), series.scans))
    shared = cleaning.shared_origin(scans[0].points)
    scans = list(map(cleaning.drop_duplicates, map(partial(cleaning.relative_to, shared), scans)))
    keep_ground, is_requested = options.ground == "keep", options.label_field is not None
    is_labelled = options.labels in ("consistent", "independent")
    scans, field, words, labels = choose_labels(scans, is_requested, is_labelled, map)
    scans, dropped = drop_labels(scans, words, options.drop_label, keep_ground)
    scans, ground_up, ground = remove_ground(scans, resolved.up, keep_ground, map)
    scans = list(map(partial(_downsampled, options=options), scans))
    if uncolored := [f"'{scan.name}'" for scan in scans if scan.colors is None]:
        note = f"colours left out ({excerpt(', '.join(uncolored))} without colours)."
        scans = [s if s.colors is None else replace(s, colors=None).noting(note) for s in scans]
    size = require_one_unit(scans, resolved.unit)
    return replace(
        series,
        scans=tuple(scans),
        length=resolved.unit,
        label_field=field,
        label_words=words,
        findings=(*series.findings, *labels, *dropped, *ground, size),
        ground_up=ground_up,
    )


def _downsampled(scan: Scan, options: Options) -> Scan:
    """Remove outliers and down-sample, as the options say; also drop fields that may be labels."""
    scan = replace(scan, fields={})
    if options.outliers is not None:
        scan = cleaning.drop_outliers(scan, options.outliers)
    if options.voxel is not None:
        scan = cleaning.downsample(scan, options.voxel)
    return scan if options.resample is None else cleaning.downsample_to(scan, options.resample)


@dataclass(frozen=True)
class Listing:
    """The scans of one plant, found, timed and ordered, but not read yet."""

    series: Series
    images: ImageSeries | None

    def files(self, scan: Scan) -> tuple[Path, ...]:
        """All files that a scan is read from."""
        return self.images.files(scan.path) if self.images else (scan.path,)

    def read(self, scan: Scan, options: Options, child: ChildProcess | None = None) -> Scan:
        """Read a scan from its files and remove points without finite coordinates."""
        paths = self.files(scan)
        sha256 = digest(paths)
        try:
            with input_errors(scan.path):
                read = self._read(scan.path, options, child)
        finally:  # also after an error, of which the change may be the cause
            if digest(paths) != sha256:
                hint = "bake again when it is complete"
                raise InputError(f"'{scan.path}' changed while it was read; {hint}.") from None
        scan = replace(read, name=scan.name, time=scan.time, date=scan.date, sha256=sha256)
        return cleaning.drop_non_finite(replace(scan, points=scan.points * options.scale))

    def _read(self, path: Path, options: Options, child: ChildProcess | None) -> Scan:
        use_labels = options.labels != "ignore" or bool(options.drop_label)
        if self.images:
            return self.images.read(path, use_labels)
        names, fields = ([*filter(None, o.split(","))] for o in (options.columns, options.fields))
        columns = read_columns(path, names, child)
        return choose_fields(columns, path, options.label_field, use_labels, fields)


def list_series(
    inputs: Sequence[Path], options: Options, times: Sequence[object] | None = None
) -> Listing:
    """Find, time and order the scans of a series without reading them.

    The parameters and the errors raised are those of `read_series`.
    """
    camera, file = find_camera(inputs[0]) if len(inputs) == 1 else None, options.times
    if camera:
        images = ImageSeries(camera, file)
        series = replace(images.series, fixed=True, length="mm")
        if images.has_labels and options.labels != "ignore":
            series = replace(series, root="virtual")
        if options.label_field is not None:
            reason = "holds images, whose labels are images too, not a field"
            raise InputError(f"'{inputs[0]}' {reason}: leave out --label-field.")
    else:
        images, from_folder = None, len(inputs) == 1
        series = schedule_scans(find_scans(inputs, file), file, times, from_folder)
    selected, count = series.scans[:: options.every], len(series.scans)
    if len(selected) < 2:
        left = f"--every {options.every} leaves only the first one; growth needs at least two"
        raise InputError(f"of {count} scans, {left}.")
    if options.every > 1:
        (finding,) = series.findings
        description = f"{finding.found}; of {count} scans {len(selected)}, one in {options.every}"
        series = replace(series, scans=selected, findings=(replace(finding, found=description),))
    return Listing(series, images)


def digest(paths: Sequence[Path]) -> str:
    """SHA-256 of the concatenated files, in hexadecimal; InputError if one can't be read."""
    sha256 = hashlib.sha256()
    for path in paths:
        with input_errors(path), path.open("rb") as file:
            hashlib.file_digest(file, lambda: sha256)
    return sha256.hexdigest()
