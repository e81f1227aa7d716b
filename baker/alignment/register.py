"""Coarse alignment of a series (section 3.1, ruling 19): left or brought together."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from baker.alignment.frames import best_poses, frame_finding, share_frame
from baker.alignment.icp import trimmed_icp
from baker.alignment.pose import Pose, transform_onto
from baker.alignment.sample import even_sample
from baker.alignment.stem_base import common_base, stem_labels
from baker.alignment.strangers import strangers
from baker.alignment.up_axis_search import find_up
from baker.alignment.yaw import YAWS, YawFit, direction_curve, exact_yaw, fit_yaws
from baker.geometry.parallel import MapLike, reporting
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Finding, Series


@dataclass(frozen=True)
class Alignment:
    """A series in one frame: the first scan's own."""

    up: str  # the direction of growth there: "x", "y", "z", "-x", "-y" or "-z"
    transforms: tuple[NDArray[np.float64], ...]  # (4, 4), from each scan's coordinates to that
    bases: tuple[NDArray[np.float64], ...]  # (3,) each scan's plant base there
    findings: tuple[Finding, ...] = ()  # what was decided about the way up and the frame

    @property
    def moves(self) -> list[tuple[float, float]]:
        """By how many degrees each scan was turned, and how far its plant base was moved."""
        moves = []
        for transform, base in zip(self.transforms, self.bases, strict=True):
            before = np.linalg.solve(transform, np.append(base, 1.0))[:3]
            cosine = np.clip((np.trace(transform[:3, :3]) - 1.0) / 2.0, -1.0, 1.0)
            angle = float(np.degrees(np.arccos(cosine)))
            moves.append((angle, float(np.linalg.norm(base - before))))
        return moves


def align(
    series: Series,
    method: str = "auto",
    up: str = "auto",
    root: NDArray[np.floating] | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    map: MapLike = map,
) -> Alignment:
    """Bring the scans of a series into the frame of the first.

    Parameters
    ----------
    series : Series
    method : {"auto", "turn", "icp", "none"}
        "auto" leaves scans that share a frame there, else does as "turn", which keeps the vertical,
        puts the stems' bases on one another and looks for the yaw that leaves most organs in their
        direction. "icp" is the paper's: closest points from where the scans lie (it often locks on
        a wrong yaw). "none" leaves everything where it is.
    up, root : str, (3,) float, optional
        The direction of growth, or "auto"; the base of the first scan's stem, where it is known.
    progress, map : callable, MapLike, optional
        Called with the stage, the steps done and all; maps a function over scans.

    References
    ----------
    Section 3.1 of the paper.
    """
    tell = progress or (lambda stage, done, total: None)
    scans = series.scans
    total = 2 * len(scans)  # samples, poses
    map = reporting(map, lambda done, _: tell("aligning", done, total), total - 1)
    labelled = all(scan.labels is not None for scan in scans)
    sampled = [
        (s.points, s.labels if labelled else None, s.name, s.origin - scans[0].origin)
        for s in scans
    ]
    samples = list(map(even_sample, *zip(*sampled, strict=True)))
    direction, findings = find_up(samples, up, series.ground_up)
    vertical = Vertical.named(direction)
    stems = stem_labels(samples, vertical) if labelled else [None] * len(scans)
    places, in_place = common_base(samples, stems, vertical)
    if root is not None:
        places[0] = [np.asarray(root, float)]
    transforms = [np.eye(4) for _ in samples]
    for transform, sample in zip(transforms, samples, strict=True):
        transform[:3, 3] = sample.offset
    bases = [place[0] for place in places]
    if method == "icp":
        steps = [trimmed_icp(*pair, np.eye(4)) for pair in pairwise(samples)]
        transforms = list(accumulate(steps, np.matmul, initial=np.eye(4)))
    elif method == "none":
        far = ", ".join(sample.name for sample in samples if sample.offset.any())
        doubt = f"{far} lies so far from the first scan that positions are rounded" if far else ""
        findings.append(Finding("frame", "left as it is, as asked", doubt, "--align auto"))
    elif len(scans) > 1:
        poses = best_poses(samples, places, vertical, stems, map)
        bases = [pose.base for pose in poses]
        fit = fit_yaws(poses, labelled)
        stays = method == "auto" and share_frame(fit, in_place)
        left, asked = in_place & stays, method == "turn"
        transforms = _brought_together(poses, fit, transforms, left)
        findings.append(frame_finding(samples, poses, fit, transforms, left, series.length, asked))
    findings += strangers(samples, transforms)
    tell("aligning", total, total)
    aligned = [t[:3, :3] @ base + t[:3, 3] for t, base in zip(transforms, bases, strict=True)]
    return Alignment(direction, tuple(transforms), tuple(aligned), tuple(findings))


def _brought_together(
    poses: Sequence[Pose],
    fit: YawFit,
    given: Sequence[NDArray[np.float64]],
    stays: NDArray[np.bool_],
) -> list[NDArray[np.float64]]:
    """Each scan's transform to the first one's frame: as given if it stays, else onto another.

    That is the scan before it; of a series that shares a frame, the nearest scan that stays.
    """
    transforms = list(given)
    if not stays.any():
        for at, (pair, place) in enumerate(zip(pairwise(poses), fit.places, strict=True)):
            yaw = exact_yaw(*pair, float(YAWS[place]), fit.by_label)
            transforms[at + 1] = transforms[at] @ transform_onto(*pair, yaw)
        return transforms
    staying = np.flatnonzero(stays).tolist()
    for at in np.flatnonzero(~stays).tolist():
        near = sorted(staying, key=lambda other: abs(other - at))[:2]
        curves = [direction_curve(poses[other], poses[at], fit.by_label) for other in near]
        pair, most = (poses[near[0]], poses[at]), int(np.argmax(np.sum(curves, axis=0)))
        yaw = exact_yaw(*pair, float(YAWS[most]), fit.by_label)
        transforms[at] = given[near[0]] @ transform_onto(*pair, yaw)
    to_first = np.linalg.inv(transforms[0])
    return [np.eye(4), *(to_first @ transform for transform in transforms[1:])]
