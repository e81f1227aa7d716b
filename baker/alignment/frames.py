"""Whether the scans of a series share a frame: decided once, for all of them.

Scans of one plant nearly always do, and turning them for the sake of what one leaf did spoils a
series. So they stay unless the plant bases lie apart, or most scans would fit far better turned.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.pose import Pose, pose_at
from baker.alignment.sample import EvenSample
from baker.alignment.yaw import YAWS, YawFit, direction_curve, second_yaw, wrapped
from baker.geometry.parallel import MapLike
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Finding

# Share of the organs' levers that the median pair of scans has to gain by being turned, times the
# root of the number of pairs: many pairs that gain a little are as sure as a few that gain much.
# Half of the pairs have to gain something too: one leaf may have moved. Of 20 real series in one
# frame, and 120 times three scans of them, none has both; turned at random about their stems one in
# thirty has not, of three scans two in five.
MIN_GAIN, MIN_GAIN_OF_HALF = 0.5, 0.2
CLOSE_GAIN = 0.2  # of one scan, from which on it is told
LARGE_MOVE, LARGE_TURN = 0.2, 15.0  # of the plant's largest size, and degrees: moves that are told
MOST_TOLD = 3  # scans with doubts

Points = NDArray[np.float64]


def best_poses(
    samples: Sequence[EvenSample],
    places: Sequence[Sequence[Points]],
    vertical: Vertical,
    stems: Sequence[int | None],
    map: MapLike = map,
) -> list[Pose]:
    """Each scan on that of its possible bases from which its organs point as those before do."""
    poses: list[Pose] = []

    def posed(sample: EvenSample, bases: Sequence[Points], stem: int | None) -> list[Pose]:
        return [pose_at(sample, vertical, base, stem) for base in bases]

    for tried in map(posed, samples, places, stems):
        fits = [direction_curve(poses[-1], pose, False).max() if poses else 0.0 for pose in tried]
        poses.append(tried[int(np.argmax(fits))])
    return poses


def share_frame(fit: YawFit, in_place: NDArray[np.bool_]) -> bool:
    """Whether a series stays as it is: bases in one place, and little to gain by turning."""
    gains = fit.gains[in_place[1:] & in_place[:-1]]
    if not len(gains):
        return bool(in_place.any())
    low, median = np.quantile(gains, 0.5, method="lower"), np.median(gains)
    return bool(median * np.sqrt(len(gains)) < MIN_GAIN or low < MIN_GAIN_OF_HALF)


def frame_finding(
    samples: Sequence[EvenSample],
    poses: Sequence[Pose],
    fit: YawFit,
    transforms: Sequence[Points],
    stays: NDArray[np.bool_],
    unit: str,
    asked: bool,
) -> Finding:
    """What was decided or asked about a series' frame, and the scans for which it was close."""
    size = max(float(np.ptp(pose.pool, axis=0).max()) for pose in poses)
    names, offsets = [sample.name for sample in samples], [sample.offset for sample in samples]
    moved = [
        t[:3, :3] @ pose.base + t[:3, 3] - pose.base - offset
        for t, pose, offset in zip(transforms, poses, offsets, strict=True)
    ]
    usual = np.median([by for by, stay in zip(moved, stays, strict=True) if stay] or moved, axis=0)
    moves = np.linalg.norm(moved - usual, axis=1)
    doubts, farthest, far = [], names[int(np.argmax(moves))], float(moves.max())
    length = f"{far:.3g} {unit}".strip()
    if any(offset.any() for offset in offsets):
        doubts = [f"{farthest} is in another coordinate system, {length} away"]
    elif far > LARGE_MOVE * size:
        doubts = [f"{farthest} was moved by {length}, more than a fifth of the plant's size"]
    if stays.any():
        found = "the scans share a frame and stay as they are"
        out = [name for name, stay in zip(names, stays, strict=True) if not stay]
        if out:
            found = f"the scans share a frame, but for {', '.join(out)}, brought onto the others"
        doubts += [
            f"{name} would fit the scan before better turned by {wrapped(YAWS[place]):.0f} degrees"
            for name, place, gain in zip(names[1:], fit.places, fit.gains, strict=True)
            if gain > CLOSE_GAIN and name not in out
        ]
        option = "--align turn" if stays.all() else "--align none"
    else:
        found = "each scan was turned and set on the one before"
        found += ", as asked" if asked else ", for they do not share a frame"
        turns = np.abs(wrapped(YAWS[fit.places]))
        if not doubts and turns.max() > LARGE_TURN:
            doubts = [f"{names[1 + int(turns.argmax())]} was turned by {turns.max():.0f} degrees"]
        doubts += [
            f"{name} fits the scan before nearly as well turned by a further {other:.0f} degrees"
            for name, curve, place in zip(names[1:], fit.curves, fit.places, strict=True)
            if (other := second_yaw(curve, place)) is not None
        ]
        option = "--align none"
    more = [f"and {len(doubts) - MOST_TOLD} more"] * (len(doubts) > MOST_TOLD)
    doubt = "; ".join(doubts[:MOST_TOLD] + more)
    return Finding("frame", found, doubt, option if doubt else "")
