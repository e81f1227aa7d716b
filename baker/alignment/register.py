"""Coarse alignment of a series (section 3.1, ruling 19): every scan to its predecessor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from baker.alignment.frames import best_poses, shared_frames
from baker.alignment.icp import trimmed_icp, trimmed_residual
from baker.alignment.pose import Pose, candidate_poses, transform_onto
from baker.alignment.sample import EvenSample, even_sample, touching_pairs
from baker.alignment.stem_base import base_candidates
from baker.alignment.up_axis_search import find_up_of, upright
from baker.alignment.yaw import YawFit, wrapped
from baker.geometry.parallel import MapLike, reporting
from baker.geometry.up_axis import Vertical
from baker.scans.finding import Finding

Progress = Callable[[str, int, int], None]

MIN_POINTS_FOR_YAW = 10  # different points of a scan's sample


@dataclass(frozen=True)
class PairFit:
    """How a scan was moved onto its predecessor."""

    yaw: float  # degrees about the growing direction, right-handed
    tilt: float  # degrees between the two growing directions
    shift: float  # how far the stem's base was moved, in the scans' unit
    residual: float  # root mean square distance from an even sample of the predecessor, best 4/5


@dataclass(frozen=True)
class Alignment:
    """A series in one frame: the first scan's own."""

    up: str  # the direction of growth there: "x", "y", "z", "-x", "-y" or "-z"
    transforms: tuple[NDArray[np.float64], ...]  # (4, 4), from each scan's coordinates to that
    drift: tuple[PairFit, ...]  # of each scan but the first; empty where nothing was looked for
    notes: tuple[str, ...]  # what a user should know, one sentence each
    findings: tuple[Finding, ...] = ()  # what was decided about the way up and the frame


def align(
    clouds: Sequence[NDArray[np.float32]],
    method: str = "auto",
    up: str = "auto",
    root: NDArray[np.floating] | None = None,
    progress: Progress | None = None,
    map: MapLike = map,
) -> Alignment:
    """Bring a series of clouds of one plant into the frame of the first.

    Parameters
    ----------
    clouds : sequence of (N, 3) float32 ndarray
    method : {"auto", "icp", "none"}
        "auto" keeps the vertical, puts the stems' bases on one another and looks for the yaw that
        leaves most of the plant in its direction; scans that already stand in one frame stay there.
        "icp" is the paper's: closest points from where the scans lie (it often locks on a wrong
        yaw). "none" leaves everything where it is.
    up : str
        The direction of growth, or "auto".
    root : (3,) float ndarray, optional
        Base of the first scan's stem, where it is known.
    progress : callable, optional
        Called with the stage, the steps done and all.
    map : MapLike
        Maps a function over scans.

    References
    ----------
    Section 3.1 of the paper.
    """
    if method == "none" and up != "auto":
        return Alignment(up, tuple(np.eye(4) for _ in clouds), (), ())
    tell = progress or (lambda stage, done, total: None)
    total = 3 * len(clouds) - 1  # samples, poses, yaws, and what is left at the end
    map = reporting(map, lambda done, _: tell("aligning", done, total), total - 1)
    samples = list(map(even_sample, clouds))
    direction = find_up_of(samples) if up == "auto" else up
    vertical = Vertical.named(direction)
    transforms, notes = [np.eye(4)] * len(clouds), []
    steps = [np.eye(4)] * (len(clouds) - 1)
    if method == "auto":
        first = candidate_poses(samples[0], vertical, root)[0]
        poses, yaws = best_poses(first, samples[1:], vertical, map)
        frames = shared_frames(poses, yaws)
        transforms = _brought_together(poses, yaws, frames)
        steps = [np.linalg.inv(before) @ after for before, after in pairwise(transforms)]
        if len(clouds) > 1 and len(set(frames)) == 1:
            notes.append("the scans stand in one frame already and were left there")
        else:
            notes += _jumps(frames) + _doubts(samples, yaws, frames)
    elif method == "icp":
        steps = [trimmed_icp(*pair, np.eye(4)) for pair in pairwise(samples)]
        transforms = list(accumulate(steps, np.matmul, initial=np.eye(4)))
    drift = tuple(
        _pair_fit(*pair, step, vertical)
        for pair, step in zip(pairwise(samples), steps, strict=True)
    )
    if any(not np.array_equal(transform, np.eye(4)) for transform in transforms):
        notes.insert(0, _moves(drift))
    tell("aligning", total, total)
    return Alignment(direction, tuple(transforms), drift, tuple(notes))


def _brought_together(
    poses: Sequence[Pose], yaws: Sequence[Sequence[YawFit]], frames: NDArray[np.intp]
) -> list[NDArray[np.float64]]:
    """Each scan's transform to the first: onto the one before, or with those of its own frame."""
    transforms = [np.eye(4)]
    first = {frames[0]: 0}
    for at in range(1, len(poses)):
        if frames[at] in first:
            transforms.append(transforms[first[frames[at]]])
            continue
        first[frames[at]] = at
        before, after = poses[at - 1 : at + 1]
        step = transform_onto(before, after, yaws[at - 1][0].yaw)
        transforms.append(transforms[-1] @ step)
    return transforms


def _jumps(frames: NDArray[np.intp]) -> list[str]:
    """A sentence for the scans that jumped out of the frame that most of the series poses in."""
    numbers, counts = np.unique(frames, return_counts=True)
    if counts.max() == 1:
        return []
    jumped = ", ".join(str(at + 1) for at in np.flatnonzero(frames != numbers[np.argmax(counts)]))
    return [f"most scans stand in one frame and were left there; these did not: scan {jumped}"]


def _pair_fit(
    earlier: EvenSample, later: EvenSample, step: NDArray[np.float64], vertical: Vertical
) -> PairFit:
    frame = upright(vertical)
    turn = frame @ step[:3, :3] @ frame.T
    base = base_candidates(later, vertical, touching_pairs(later))[0]
    return PairFit(
        yaw=float(np.degrees(np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1]))),
        tilt=float(np.degrees(np.arccos(np.clip(turn[2, 2], -1.0, 1.0)))),
        shift=float(np.linalg.norm(step[:3, :3] @ base + step[:3, 3] - base)),
        residual=trimmed_residual(earlier, later, step),
    )


def _moves(drift: Sequence[PairFit]) -> str:
    yaw, tilt, shift = (
        max(abs(getattr(fit, name)) for fit in drift) for name in ("yaw", "tilt", "shift")
    )
    return (
        f"the scans were turned onto their predecessors by up to {yaw:.1f} degrees, tilted by up "
        f"to {tilt:.1f} degrees and moved by up to {shift:.4g}"
    )


def _doubts(
    samples: Sequence[EvenSample], yaws: Sequence[Sequence[YawFit]], frames: NDArray[np.intp]
) -> list[str]:
    """A sentence for every scan that was turned and might as well stand another way round."""
    doubts = []
    for at, (pair, likely) in enumerate(zip(pairwise(samples), yaws, strict=True)):
        if frames[at] == frames[at + 1]:
            continue
        if min(len(sample.points) for sample in pair) < MIN_POINTS_FOR_YAW:
            doubts.append(f"scan {at + 2} or its predecessor has too few points to find its yaw")
        elif len(likely) > 1:
            further = abs(wrapped(likely[1].yaw - likely[0].yaw))
            doubts.append(
                f"scan {at + 2} fits its predecessor nearly as well when turned by a further "
                f"{further:.0f} degrees (so much of the plant keeps its direction: "
                f"{likely[0].overlap:.0%}, or {likely[1].overlap:.0%})"
            )
    return doubts
