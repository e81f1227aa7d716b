"""What the report draws: the states it asks for pictures of, and the organs' growth curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.up_axis import Vertical
from baker.pipeline import BakeRecord
from baker.report.errormap import ErrorScale
from baker.report.pictures import Picture, PictureRequest
from baker.report.verification import HoldoutError
from baker.verdict import Doubt
from gclip import Clip
from traits.axis import axis_of
from traits.organs import samples_at

NEUTRAL_COLOR = (150, 158, 146)  # of organs and points that a picture is not about
MAX_SCANS_PICTURED = 12  # evenly chosen of more
MAX_DOUBTS_PICTURED = 4  # intervals, the most doubtful ones
POINTS_FOR_LENGTH = 800  # of an organ, that its length is measured on
SCALE_BAR_SHARE = 0.3  # of a picture's width, that the scale bar has at most
MAX_TICKS = 5  # of the growth curves' axis, above 0


@dataclass(frozen=True)
class Curve:
    """The lengths of one organ at the scans that show it."""

    track: int
    times: list[float]
    lengths: list[float]

    @property
    def last(self) -> float:
        return self.lengths[-1]


@dataclass(frozen=True)
class ScaleBar:
    """A round length, and how many pixels of a picture it is in the middle of the plant."""

    length: float
    pixels: float


def scans_pictured(clip: Clip) -> list[int]:
    """Indices of the scans that the report shows."""
    count = len(clip.scans)
    even = np.linspace(0, count - 1, min(count, MAX_SCANS_PICTURED))
    return [round(index) for index in even.tolist()]


def picture_requests(
    clip: Clip,
    record: BakeRecord,
    doubts: Sequence[Sequence[Doubt]],
    errors: Sequence[HoldoutError],
    scale: ErrorScale | None,
) -> dict[str, PictureRequest]:
    """All pictures of the report, by name.

    Of each scan; of each interval of `doubts`, at both scans and half-way, with the organs in doubt
    in their colours; of each scan left out the scan, its reconstruction and the error in colours.
    """
    palette = clip.palette[:, :3]
    requests = {}
    for k in scans_pictured(clip):
        points, tracks = _scan(clip, clip.times[k])
        requests[f"scan-{k}"] = PictureRequest(points, palette[tracks])
    for k, own in enumerate(doubts):
        colors = np.tile(np.array(NEUTRAL_COLOR, np.uint8), (len(palette), 1))
        about = [doubt.track for doubt in own]
        colors[about] = palette[about]
        start, end = own[0].start, own[0].end
        between = clip.at((start + end) / 2)
        states = _scan(clip, start), (between.local, between.tracks), _scan(clip, end)
        for state, (points, tracks) in enumerate(states):
            requests[f"doubt-{k}-{state}"] = PictureRequest(points, colors[tracks])
    for k, (held, error) in enumerate(zip(record.held_out, errors, strict=True)):
        assert scale is not None
        for name, points in (
            ("real", held.keyframe.positions),
            ("reconstruction", error.reconstruction),
        ):
            plain = np.full((len(points), 3), NEUTRAL_COLOR, np.uint8)
            requests[f"{name}-{k}"] = PictureRequest(points, plain)
        colors = scale.colors(error.distances)
        requests[f"error-{k}"] = PictureRequest(error.reconstruction, colors)
    return requests


def growth_curves(clip: Clip) -> list[Curve]:
    """Lengths of the organs along their midlines at the scans, the longest organ first.

    They are measured on fewer points than those of `bake --traits`, which says how sure each is.
    """
    vertical = Vertical.named(clip.up)
    up = vertical.sign * np.eye(3)[vertical.axis]
    born = {track.id: track.born for track in clip.track_table}
    parents = {track.id: track.parent for track in clip.track_table}
    found: dict[int, list[tuple[float, float]]] = {}
    for time in clip.times:
        (sample,) = samples_at(clip, time)
        clouds: dict[int | None, NDArray[np.float64]] = {
            track: organ.points[:: -(-len(organ.points) // POINTS_FOR_LENGTH)]
            for track, organ in sample.organs.items()
            if born[track] <= time
        }
        for track in sample.organs.keys() & clouds.keys():
            cloud = clouds[track]
            axis = axis_of(cloud, clouds.get(parents[track], np.zeros((0, 3))), up)
            if axis is not None:
                found.setdefault(track, []).append((time, axis.length))
    curves = [Curve(t, *map(list, zip(*values, strict=True))) for t, values in found.items()]
    return sorted(curves, key=lambda curve: -max(curve.lengths))


def scale_bar(clip: Clip, picture: Picture) -> ScaleBar | None:
    """A bar of 1, 2 or 5 times a power of ten for a picture of the whole plant."""
    low, high = clip.bounds
    middle, width = (low + high) / 2, float(np.linalg.norm(high - low))
    if width == 0.0:
        return None  # a plant of one point
    # Seen from any side: of all directions across the view the longest appears unshortened.
    steps = picture.project(middle + width * 1e-3 * np.eye(3)) - picture.project(middle[None])
    pixels = float(np.linalg.svd(steps)[1][0]) / (width * 1e-3)
    length = _round_length(SCALE_BAR_SHARE * picture.size[0] / pixels)
    return ScaleBar(length, length * pixels)


def length_ticks(curves: Sequence[Curve]) -> list[float]:
    """Round lengths from 0 to no less than the longest of the growth curves."""
    longest = max((max(curve.lengths) for curve in curves), default=1.0)
    step = _round_length(2.5 * longest / MAX_TICKS)  # rounding may more than halve it
    return [step * k for k in range(int(np.ceil(longest / step)) + 1)]


def _round_length(longest: float) -> float:
    """The largest length of 1, 2 or 5 times a power of ten that is not longer."""
    power = 10.0 ** np.floor(np.log10(longest))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest))


def _scan(clip: Clip, time: float) -> tuple[NDArray[np.float32], NDArray[np.integer]]:
    """The points of a scan and their organs, without those that the next scan's unfold from."""
    frame = clip.at(time)
    shown = np.array([track.born for track in clip.track_table])[frame.tracks] <= time
    return frame.local[shown], frame.tracks[shown]
