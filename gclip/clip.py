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
from gclip.file import (
    Container,
    decode_document,
    encode_document,
    open_container,
    verify_checksums,
    write_container,
)
from gclip.schema import (
    CURVES,
    FIELD,
    OPTIONAL,
    Document,
    Interval,
    Track,
    check_buffer,
)

if TYPE_CHECKING:
    from open3d.geometry import PointCloud
    from pandas import DataFrame

ROUNDING = 1e-9  # share of the series' length by which a time may be outside
HELD_OUT = "held_out/%04d"  # name of a buffer, by the index of the scan


class Tracks(dict[str, Track]):
    """Tracks by name."""

    def __missing__(self, name: str) -> Track:
        raise KeyError(f"no track is called {name!r}; these are: {', '.join(self)}")


@dataclass(frozen=True, repr=False, kw_only=True)
class Clip(Document):
    """The animated growth of a plant."""

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
        buffers = _buffers(self)
        text = encode_document(_content(self), buffers)
        container = Container(text, buffers, sum(array.nbytes for array in buffers.values()))
        try:
            _read_clip(container)
            write_container(Path(path), container, force)
        except ClipError as error:
            raise ClipError(f"{os.fspath(path)} can't be written: {error}.") from None


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
        return _read_clip(open_container(Path(path)))
    except ClipError as error:
        raise ClipError(f"{os.fspath(path)}: {error}.") from None


def check(path: str | os.PathLike[str]) -> str:
    """Check a file to its last byte: all that `open` checks, and the checksums.

    Returns what the clip contains. Raises ClipError, without the file's name and a full stop.
    """
    container = open_container(Path(path))
    clip = _read_clip(container)
    checksums = verify_checksums(container)
    return (
        f"{len(clip.scans)} scans, {len(clip.intervals)} intervals, "
        f"{len(container.buffers)} buffers, {container.size:,} bytes, {checksums}"
    )


def _read_clip(container: Container) -> Clip:
    """The clip that a container holds. Raises ClipError without the file's name."""
    clip = decode_document(container, Clip)
    buffers: dict[str, Any] = dict(container.buffers)
    try:
        intervals = [_with_buffers(clip, k, buffers) for k in range(len(clip.intervals))]
        held_out = []
        for i, scan in enumerate(clip.held_out):
            positions = buffers.pop(HELD_OUT % i, None)
            check_buffer(HELD_OUT % i, positions, (scan.points, 3), np.float32)
            held_out.append(replace(scan, positions=positions))
    except ValueError as error:
        raise ClipError(str(error)) from None
    if buffers:
        raise ClipError(f'it holds a buffer "{min(buffers)[:40]}" that nothing names')
    largest, count = max(int(i.tracks.max()) for i in intervals), len(clip.track_table)
    if largest >= count:
        raise ClipError(f"its movers name track {largest}; only {count} tracks are named")
    return replace(clip, intervals=tuple(intervals), held_out=tuple(held_out))


def _with_buffers(clip: Clip, k: int, buffers: dict[str, Any]) -> Interval:
    """Interval number k of a document, with its arrays, which are taken out of the buffers."""
    interval = clip.intervals[k]

    def take(*names: str) -> tuple[Any, ...]:
        return tuple(buffers.pop(f"{k:04d}/{name}", None) for name in names)

    try:
        return replace(
            interval,
            curve=take(*CURVES[interval.degree]),
            tracks=take("track")[0],
            fields=take(*(FIELD % i for i in range(len(clip.fields)))),
            **dict(zip(OPTIONAL, take(*OPTIONAL.values()), strict=True)),
        )
    except ValueError as error:
        raise ValueError(f"in interval {k}, {error}") from None


def _buffers(clip: Clip) -> dict[str, NDArray[Any]]:
    """The arrays of a clip by the names of their buffers."""
    buffers = {HELD_OUT % i: scan.positions for i, scan in enumerate(clip.held_out)}
    for k, interval in enumerate(clip.intervals):
        buffers |= {f"{k:04d}/{name}": array for name, array in interval.buffers().items()}
    return {name: np.ascontiguousarray(array) for name, array in buffers.items()}


def _content(clip: Clip) -> dict[str, Any]:
    """The document that describes a clip, without version and checksums."""
    arrays = ("curve", "tracks", *OPTIONAL, "fields")
    content = {
        **_attributes(clip, "track_table"),
        "scans": [_attributes(scan, "positions") for scan in clip.scans],
        "tracks": [_attributes(track, "id") for track in clip.track_table],
        "intervals": [_attributes(interval, *arrays) for interval in clip.intervals],
        "held_out": [_attributes(scan, "positions") for scan in clip.held_out],
    }
    optional = {"fields", "held_out"}
    return {name: value for name, value in content.items() if value or name not in optional}


def _attributes(holder: Any, *left_out: str) -> dict[str, Any]:
    names = [each.name for each in fields(holder) if each.name not in left_out]
    return {name: getattr(holder, name) for name in names}
