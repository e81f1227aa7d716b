"""Coarse alignment of a series to the frame of its first scan (section 3.1)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from baker.alignment.frames import frame_finding, share_frame
from baker.alignment.icp import trimmed_icp
from baker.alignment.pose import Pose, pose_at, transform_onto
from baker.alignment.same_plant import same_plant_findings
from baker.alignment.sample import even_sample
from baker.alignment.stem_base import common_base, stem_labels
from baker.alignment.up_axis_search import find_up
from baker.alignment.yaw import YAWS, YawFit, fit_yaws, refined_yaw
from baker.geometry.parallel import MapLike, reporting
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Finding, Series

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Alignment:
    """The transforms of the scans of a series to one frame, that of the first scan."""

    up: str  # the direction of growth: "x", "y", "z", "-x", "-y" or "-z"
    transforms: Array  # (S, 4, 4) from each scan's coordinates
    bases: Array  # (S, 3) plant base of each scan, in the common frame
    findings: tuple[Finding, ...] = ()  # about the up axis, the frame and the plant

    @property
    def moves(self) -> list[tuple[float, float]]:
        """The rotation of each scan in degrees, and the distance that its base was moved."""
        cosines = (np.trace(self.transforms[:, :3, :3], axis1=1, axis2=2) - 1.0) / 2.0
        angles = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
        before = _bases_in_frame(self.bases, np.linalg.inv(self.transforms))
        return list(zip(angles, np.linalg.norm(self.bases - before, axis=1), strict=True))


def align(
    series: Series,
    method: str = "auto",
    up: str = "auto",
    root: NDArray[np.floating] | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    map: MapLike = map,
) -> Alignment:
    """Align the scans of a series to the frame of the first one (section 3.1 of the paper).

    Parameters
    ----------
    series : Series
    method : {"auto", "turn", "icp", "none"}
        "auto" leaves scans that share a frame as they are, and otherwise does the same as "turn",
        which registers the plant bases and rotates about the vertical, by the yaw for which the
        directions of most organs agree. "icp" is the method of the paper, which often converges to
        a wrong yaw. "none" moves no scan.
    up : str
        The direction of growth, or "auto".
    root : (3,) float, optional
        The plant base of the first scan.
    progress : callable, optional
        Called with the name of the stage, the number of steps done and their total.
    map : map-like callable
        Maps over the scans.
    """
    progress = progress or (lambda stage, done, total: None)
    scans = series.scans
    total = len(scans) + 1  # a step for the sample of each scan, and one for the alignment
    with_progress = reporting(map, lambda done, _: progress("aligning", done, total), len(scans))
    labelled = all(scan.labels is not None for scan in scans)
    clouds, names = [scan.points for scan in scans], [scan.name for scan in scans]
    labels = [scan.labels if labelled else None for scan in scans]
    offsets = np.array([scan.origin - scans[0].origin for scan in scans])
    samples = list(with_progress(even_sample, clouds, labels, names, offsets))
    direction, findings = find_up(samples, up, series.ground_up)
    vertical = Vertical.named(direction)
    stems = stem_labels(samples, vertical, map) if labelled else [None] * len(scans)
    bases, in_place = common_base(samples, stems, vertical)
    if root is not None:
        bases[0] = root
    transforms = np.tile(np.eye(4), (len(scans), 1, 1))
    transforms[:, :3, 3] = offsets
    if method == "icp":
        steps = [trimmed_icp(*pair) for pair in pairwise(samples)]
        transforms = np.array([*accumulate(steps, np.matmul, initial=np.eye(4))])
    elif method == "none":
        remote = ", ".join(sample.name for sample in samples if sample.offset.any())
        doubt = f"{remote} lies so far from the first scan that positions are rounded"
        doubt = doubt if remote else ""
        findings.append(Finding("frame", "left as it is, as asked", doubt, "--align auto"))
    elif len(scans) > 1:
        poses = [pose_at(*scan, vertical) for scan in zip(samples, bases, stems, strict=True)]
        fit = fit_yaws(poses, labelled)
        stays = in_place & (method == "auto" and share_frame(fit, in_place))
        transforms = _register_scans(poses, fit, transforms, stays)
        moves = _bases_in_frame(bases, transforms) - bases - offsets
        findings.append(
            frame_finding(samples, moves, fit, stays, series.length, is_requested=method == "turn")
        )
    findings += same_plant_findings(samples, transforms, map)
    progress("aligning", total, total)
    return Alignment(direction, transforms, _bases_in_frame(bases, transforms), (*findings,))


def _bases_in_frame(bases: Array, transforms: NDArray[np.floating]) -> Array:
    """(S, 3) the base of each scan in the common frame."""
    return np.einsum("sij,sj->si", transforms[:, :3, :3], bases) + transforms[:, :3, 3]


def _register_scans(
    poses: Sequence[Pose], fit: YawFit, unmoved: Array, stays: NDArray[np.bool_]
) -> Array:
    """(S, 4, 4) transforms to the frame of the first scan; `unmoved` for scans that stay.

    The others are registered with the nearest scan that stays or, if none does, the previous scan.
    """
    transforms, staying = unmoved.copy(), np.flatnonzero(stays).tolist()
    directions = np.append(0, np.cumsum(fit.yaw_indices))  # of the scans, as indices in YAWS
    for k in range(0 if staying else 1, len(poses)):
        if not stays[k]:
            reference = min(staying, key=lambda scan: abs(scan - k)) if staying else k - 1
            yaw = float(YAWS[(directions[k] - directions[reference]) % len(YAWS)])
            yaw = refined_yaw(poses[reference], poses[k], yaw, fit.by_label)
            transforms[k] = transforms[reference] @ transform_onto(poses[reference], poses[k], yaw)
    transforms[1:] = np.linalg.inv(transforms[0]) @ transforms[1:]
    transforms[0] = np.eye(4)
    return transforms
