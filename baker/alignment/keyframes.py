"""The aligned series, which all later stages work on."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.alignment.register import Alignment
from baker.errors import InputError
from baker.geometry.neighbors import Neighbors
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Series
from gclip import ScanMark


@dataclass(frozen=True)
class Keyframe:
    """An aligned scan."""

    positions: NDArray[np.float32]  # (N, 3) relative to the clip's origin
    colors: NDArray[np.uint8] | None  # (N, 4) sRGB and alpha
    area: NDArray[np.floating] | None = None  # (N,); None if no movers are to be added
    base: NDArray[np.float64] | None = None  # (3,) plant base
    normals: NDArray[np.uint8] | None = None  # (N, 2) octahedral codes


@dataclass(frozen=True)
class AlignedSeries:
    """The scans to bake in one frame, with their nearest neighbours and plant bases."""

    times: tuple[float, ...]
    keyframes: tuple[Keyframe, ...]
    neighbors: tuple[Neighbors, ...]
    bases: tuple[int, ...]  # index of the point at the plant base, for each scan
    vertical: Vertical

    @property
    def clouds(self) -> list[NDArray[np.float32]]:
        """(N, 3) positions of each scan."""
        return [frame.positions for frame in self.keyframes]

    @property
    def base_points(self) -> list[NDArray[np.float32]]:
        """(3,) position of the plant base in each scan."""
        return [cloud[k] for cloud, k in zip(self.clouds, self.bases, strict=True)]

    @property
    def spacings(self) -> list[float]:
        """Point spacing of each scan."""
        return [neighbors.spacing for neighbors in self.neighbors]

    @property
    def spacing(self) -> float:
        """Median point spacing of all scans."""
        return float(np.median(self.spacings))

    @property
    def floor(self) -> float:
        """Height of the lowest plant base, to which lost organs fall."""
        return float(self.vertical.height(np.stack(self.base_points)).min())


def aligned_keyframes(series: Series, alignment: Alignment) -> list[Keyframe]:
    """Transform the scans to the common frame; those that do not move stay exactly the same."""
    keyframes = []
    scans = zip(series.scans, alignment.transforms, alignment.bases, strict=True)
    for scan, transform, base in scans:
        moved = scan.points @ transform[:3, :3].T + transform[:3, 3]  # exact for the identity
        opaque = np.full((len(scan), 1), 255, np.uint8)
        colors = None if scan.colors is None else np.hstack([scan.colors, opaque])
        keyframes.append(Keyframe(moved.astype(np.float32), colors, base=base))
    return keyframes


def hold_out(
    series: Series, keyframes: Sequence[Keyframe], every: int | None
) -> tuple[Series, list[Keyframe], tuple[ScanMark, ...]]:
    """Split an aligned series into the scans to bake and those left out (section 4, Figure 13).

    every: leave out the scans numbered `every`, 2 `every`, ... from 1; by default none. The first
    and the last scan always stay, since a clip can't be evaluated outside the series. Raises
    InputError if no scan would be left out.
    """
    count = len(series.scans)
    left_out = range(every - 1, count - 1, every) if every is not None else ()
    if every is not None and not left_out:
        raise InputError(
            f"--holdout {every} leaves none of the {count} scans out; "
            f"at least {every + 1} are needed, for the first and the last always stay."
        )
    baked = [k for k in range(count) if k not in left_out]
    excluded = [(series.scans[k], keyframes[k].positions) for k in left_out]
    held_out = tuple(ScanMark(s.name, s.time, s.date, len(p), p) for s, p in excluded)
    series = replace(series, scans=tuple(series.scans[k] for k in baked))
    return series, [keyframes[k] for k in baked], held_out
