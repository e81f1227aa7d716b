"""Decide whether the scans of a series already share a frame.

Scans of one plant usually do, and a rotation that follows the motion of a single leaf would be
wrong. So scans stay as they are, unless their plant bases differ or most of them would fit much
better rotated.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample
from baker.alignment.yaw import YAWS, YawFit, second_yaw, wrapped
from baker.scans.scan import Finding

# Scans are rotated if the lower median of the gains in fit of the pairs, times the square root of
# their number, is at least MIN_GAIN. None of 19 real series in one frame reaches it, nor of 57
# triples of their scans, with and without labels; of series rotated at random about their stems all
# do, of triples 4 in 7.
MIN_GAIN = 0.4
CLOSE_GAIN = 0.2  # gain in fit of a single scan above which it is reported as a doubt
# Series in one frame have 0.7 or more (three scans 0.2), 13 of 15 rotated ones that stay 0.54.
MIN_DISTINCTION = 0.6
LARGE_MOVE = 0.2  # share of the plant's size; a scan that is moved farther is reported as a doubt
MAX_LISTED_DOUBTS = 3  # of the finding


def share_frame(fit: YawFit, in_place: NDArray[np.bool_]) -> bool:
    """Whether rotating the scans of a series whose bases are `in_place` would gain little fit."""
    gains = fit.gains[in_place[1:] & in_place[:-1]]
    if not len(gains):
        return bool(in_place.any())
    return bool(np.quantile(gains, 0.5, method="lower") * np.sqrt(len(gains)) < MIN_GAIN)


def frame_finding(
    samples: Sequence[EvenSample],
    moves: NDArray[np.float64],
    fit: YawFit,
    stays: NDArray[np.bool_],
    unit: str,
    is_requested: bool,
) -> Finding:
    """The finding about the frame of a series, with doubts about single scans.

    moves: (S, 3) displacements of the plant bases. stays: (S,) whether the scan stays as it is.
    unit: of lengths. is_requested: whether the user asked for the scans to be rotated.
    """
    names = [sample.name for sample in samples]
    size = max(float(np.ptp(sample.points, axis=0).max()) for sample in samples)
    usual_move = np.median(moves[stays] if stays.any() else moves, axis=0)
    distances = np.linalg.norm(moves - usual_move, axis=1)
    farthest, longest = names[int(np.argmax(distances))], float(distances.max())
    length, doubts = f"{longest:.3g} {unit}".strip(), []
    if any(sample.offset.any() for sample in samples):
        doubts = [f"{farthest} is in another coordinate system, {length} away"]
    elif longest > LARGE_MOVE * size:
        doubts = [f"{farthest} was moved by {length}, more than a fifth of the plant's size"]
    later = zip(names[1:], fit.curves, fit.yaw_indices, fit.gains, strict=True)
    if stays.any():
        registered = [name for name, stay in zip(names, stays, strict=True) if not stay]
        rest = f", but for {', '.join(registered)}, brought onto the others"
        description = f"the scans share a frame{rest if registered else ' and stay as they are'}"
        if fit.distinction < MIN_DISTINCTION:
            doubts.append("turned at random, they would fit each other nearly as well")
        doubts += [
            f"{name} would fit the scan before better turned by {wrapped(YAWS[index]):.0f} degrees"
            for name, _, index, gain in later
            if gain > CLOSE_GAIN and name not in registered
        ]
    else:
        reason = "as asked" if is_requested else "for they do not share a frame"
        description = f"each scan was turned and set on the one before, {reason}"
        doubts += [
            f"{name} fits the scan before nearly as well turned by a further {angle:.0f} degrees"
            for name, curve, index, _ in later
            if (angle := second_yaw(curve, index)) is not None
        ]
    if len(doubts) > MAX_LISTED_DOUBTS:
        doubts[MAX_LISTED_DOUBTS:] = [f"and {len(doubts) - MAX_LISTED_DOUBTS} more"]
    option = "--align turn" if stays.all() else "--align none"
    return Finding("frame", description, "; ".join(doubts), option if doubts else "")
