"""The growth clip: movers between scans, tracks of organs, and their provenance.

A **mover** is one animated point in the **interval** between two successive scans. It moves along a
Bézier curve of the interval's degree (1, 2 or 3): start, control points, end. A **track** is one
organ throughout the series.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from gclip.errors import ClipError
from gclip.evaluate import Frame, frame_at
from gclip.file import Container, open_container, read_document, verify_checksums, write_file
from gclip.schema import (
    CURVES,
    OPTIONAL,
    ClipHeader,
    Document,
    HeldOutScan,
    Interval,
    PointField,
    ScanMark,
    Track,
    check_buffer,
)

if TYPE_CHECKING:
    from open3d.geometry import PointCloud
    from pandas import DataFrame

ROUNDING = 1e-9  # share of the series' length by which a time may be outside
FIELD = "%04d/field%d"  # name of a buffer, by interval and field
HELD_OUT = "held_out/%04d"  # name of a buffer, by the scan that was left out
# Fields of a clip, a track and an interval as a document has them.
HEADER = [field.name for field in fields(ClipHeader)]
TRACK = ["name", "color", "parent", "born", "lost", "kind"]
INTERVAL = ["start", "end", "degree", "groups", "box", "segments"]


class Tracks(dict[str, Track]):
    """Tracks by name."""

    def __missing__(self, name: str) -> Track:
        raise KeyError(f"no track is called {name!r}; these are: {', '.join(self)}")


@dataclass(frozen=True, repr=False, kw_only=True)
class Clip(ClipHeader):
    """The animated growth of a plant."""

    intervals: tuple[Interval, ...]  #: between successive scans
    track_table: tuple[Track, ...]  #: by id
    up: str = "z"
    fields: tuple[PointField, ...] = ()  #: scalars of the scans' points besides colours
    held_out: tuple[HeldOutScan, ...] = ()  #: scans left out of the bake, sorted by time

    @property
    def times(self) -> list[float]:
        """The scans' times, ascending."""
        return [scan.time for scan in self.scans]

    @property
    def tracks(self) -> Tracks:
        """The tracks by name: ``clip.tracks["leaf 3"]``."""
        return Tracks({track.name: track for track in self.track_table})

    @property
    def has_colors(self) -> bool:
        """Whether the movers have the colours of the scans."""
        return any(interval.start_colors is not None for interval in self.intervals)

    @property
    def palette(self) -> NDArray[np.uint8]:
        """(tracks, 4) uint8 sRGB and alpha: the colours of the tracks by id."""
        return np.array([(*track.color, 255) for track in self.track_table], np.uint8)

    @property
    def bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lower and upper corner of all movers, with control points, relative to the origin."""
        corners = np.array([interval.bounds for interval in self.intervals])
        return corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)

    def __repr__(self) -> str:
        times, unit = self.times, self.time_unit.removesuffix("s")
        span = f"{unit} {times[0]:g} to {unit} {times[-1]:g}"
        movers = sum(map(len, self.intervals))
        return (
            f"<gclip.Clip: {len(times)} scans, {span}, {len(self.track_table)} tracks, "
            f"{movers:,} movers{', ' + self.unit if self.unit else ''}>"
        )

    @overload
    def at(self, day: float) -> Frame: ...

    @overload
    def at(self, day: Sequence[float] | NDArray[np.floating]) -> list[Frame]: ...

    def at(self, day: Any) -> Frame | list[Frame]:
        """Evaluate the clip at a time, or at several.

        Parameters
        ----------
        day : float, or sequence of float
            In the clip's unit of time, from the first to the last scan.

        Returns
        -------
        Frame, or list of Frame
            At the time of a scan, the set of positions is exactly that of the scan's points. Within
            an interval, the movers are in the same order at all times.

        Raises
        ------
        ValueError
            For a time outside the series.
        """
        if np.ndim(day):
            return list(map(self.at, day))
        self.check_day(day)
        return frame_at(self, day)

    def check_day(self, day: float) -> None:
        """Raise ValueError for a time outside the series."""
        first, last = self.times[0], self.times[-1]
        tolerance = ROUNDING * (last - first)  # for sums of time steps
        if not first - tolerance <= day <= last + tolerance:
            span = f"{first:g} to {last:g}"
            raise ValueError(f"{day:g} is outside the series, whose {self.time_unit} are {span}")

    def traits(self, days: Sequence[float] | None = None) -> DataFrame:
        """Lengths, areas, angles and growth rates of the organs; see `traits.data_frame`."""
        table: DataFrame = import_module("traits").data_frame(self, days)
        return table

    def show(self) -> None:
        """Play the clip in a window until it is closed; `player.show` takes options."""
        import_module("player").show(self)

    def _repr_html_(self) -> str:
        """The page that plays the clip, for notebooks."""
        return str(import_module("player").iframe(self))

    def to_open3d(self, day: float) -> PointCloud:
        """The plant at a time as a coloured Open3D point cloud, in the frame of the input."""
        from open3d import geometry, utility

        frame = self.at(day)
        cloud = geometry.PointCloud(utility.Vector3dVector(frame.positions))
        cloud.colors = utility.Vector3dVector(frame.colors[:, :3] / 255.0)
        return cloud

    def save(self, path: str | os.PathLike[str], force: bool = True) -> None:
        """Write the clip to a file; if that fails, an existing file stays unchanged.

        Parameters
        ----------
        path : str or path-like
        force : bool, optional
            Whether an existing file is replaced.

        Raises
        ------
        UserError
            If `path` can't be written, or exists and is not to be replaced.
        ClipError
            If `gclip.open` would refuse the clip.
        """
        write_file(Path(path), _content(self), _buffers(self), force)


def open(path: str | os.PathLike[str]) -> Clip:
    """Open a clip, memory-mapped, and check it.

    Checksums are not verified, since that would read the whole file (see `gclip.check`).

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    Clip
        Its buffers are read-only views of the file.

    Raises
    ------
    ClipError
        If the file can't be read or is damaged; the message is one sentence.
    """
    try:
        container = open_container(Path(path))
        return _read_clip(container, read_document(container))
    except ClipError as error:
        raise ClipError(f"{os.fspath(path)}: {error}.") from None


def check(path: str | os.PathLike[str]) -> str:
    """Check a file to its last byte: all that `open` checks, and the checksums.

    Returns what the clip contains. Raises ClipError, without the file's name and a full stop.
    """
    container = open_container(Path(path))
    document = read_document(container)
    checksums = "no checksums: it was written before format 1.1"
    if document.sha256:
        verify_checksums(container, document.sha256)
        checksums = f"{len(document.sha256)} checksums agree"
    clip = _read_clip(container, document)
    return (
        f"{len(clip.scans)} scans, {len(clip.intervals)} intervals, "
        f"{len(container.buffers)} buffers, {container.size:,} bytes, {checksums}"
    )


def _read_clip(container: Container, document: Document) -> Clip:
    """The clip that a container holds. Raises ClipError without the file's name."""
    buffers: dict[str, Any] = dict(container.buffers)

    def take(name: str, count: int, columns: int) -> NDArray[np.float32]:
        buffer = buffers.pop(name, None)
        check_buffer(name, buffer, (count, columns), np.float32)
        return buffer

    try:
        intervals = [_with_buffers(e, k, buffers) for k, e in enumerate(document.intervals)]
        counts = [(k, len(interval)) for k, interval in enumerate(intervals)]
        point_fields = tuple(
            PointField(name, tuple(take(FIELD % (k, i), count, 2) for k, count in counts))
            for i, name in enumerate(document.fields)
        )
        held_out = tuple(
            HeldOutScan(s.name, s.time, s.date, take(HELD_OUT % i, s.points, 3))
            for i, s in enumerate(document.held_out)
        )
    except ValueError as error:
        raise ClipError(str(error)) from None
    if buffers:
        raise ClipError(f'it holds a buffer "{min(buffers)[:40]}" that nothing names')
    largest, count = max(int(i.tracks.max()) for i in intervals), len(document.tracks)
    if largest >= count:
        raise ClipError(f"its movers name track {largest}; only {count} tracks are named")
    return Clip(
        intervals=tuple(intervals),
        track_table=document.tracks,
        fields=point_fields,
        held_out=held_out,
        **_fields(document, HEADER),
    )


def _with_buffers(entry: Interval, k: int, buffers: dict[str, Any]) -> Interval:
    """Interval number k of a document, with its arrays, which are taken out of the buffers."""
    names = {**OPTIONAL, "tracks": "track"}
    arrays = {field: buffers.pop(f"{k:04d}/{name}", None) for field, name in names.items()}
    curve = tuple(buffers.pop(f"{k:04d}/{name}", None) for name in CURVES[entry.degree])
    try:
        return replace(entry, curve=curve, **arrays)
    except ValueError as error:
        raise ValueError(f"in interval {k}, {error}") from None


def _buffers(clip: Clip) -> dict[str, NDArray[Any]]:
    """The arrays of a clip by the names of their buffers."""
    buffers = {HELD_OUT % i: scan.positions for i, scan in enumerate(clip.held_out)}
    for k, interval in enumerate(clip.intervals):
        buffers |= {f"{k:04d}/{name}": array for name, array in interval.buffers().items()}
        buffers |= {FIELD % (k, i): field.values[k] for i, field in enumerate(clip.fields)}
    return buffers


def _content(clip: Clip) -> dict[str, Any]:
    """The fields of the document that describes a clip."""
    held_out = [ScanMark(s.name, s.time, s.date, len(s.positions)) for s in clip.held_out]
    return {
        **_fields(clip, HEADER),
        "tracks": [_fields(track, TRACK) for track in clip.track_table],
        "intervals": [_fields(interval, INTERVAL) for interval in clip.intervals],
        **({"held_out": held_out} if held_out else {}),
        **({"fields": [field.name for field in clip.fields]} if clip.fields else {}),
    }


def _fields(holder: object, names: list[str]) -> dict[str, Any]:
    return {name: getattr(holder, name) for name in names}
