"""The error of rebuilt scans in colours, blue to red (the paper's Figure 13)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.report.verification import HoldoutError

COLORMAP = "turbo"  # blue to red, and unlike "jet" even in between (Mikhailov 2019)
BLUE, RED = 0.08, 0.96  # the part of it that is neither black nor purple
MOST = 0.995  # share of all points that the scale covers
BARS = 48
BAR_HEIGHT = 54.0


@dataclass(frozen=True)
class Scale:
    """Distances from 0 to `top`, in the unit cube, are blue to red; farther ones are red too."""

    top: float

    def colors(self, distances: NDArray[np.floating]) -> NDArray[np.uint8]:
        """(N, 3) uint8 sRGB of (N,) distances."""
        import cmap

        share = np.clip(np.asarray(distances, float) / self.top, 0.0, 1.0)
        rgba = cmap.Colormap(COLORMAP)(BLUE + (RED - BLUE) * share)
        return np.round(255.0 * np.atleast_2d(rgba)[:, :3]).astype(np.uint8)


@dataclass(frozen=True)
class Bar:
    """One bar of the legend: x and height as shares of the legend, and its colour."""

    x: float
    height: float
    color: str


def common_scale(errors: Sequence[HoldoutError]) -> Scale:
    """One scale for all scans left out; the few farthest points don't wash out the others."""
    distances = np.concatenate([error.distances for error in errors])
    return Scale(max(float(np.quantile(distances, MOST)), 1e-9))


def histogram(error: HoldoutError, scale: Scale) -> list[Bar]:
    """How many points lie how far off: the legend of the error map, as high as there are many."""
    clipped = np.minimum(error.distances, scale.top)
    counts, edges = np.histogram(clipped, BARS, (0.0, scale.top))
    heights = (counts / max(counts.max(), 1)) ** 0.5
    middles = (edges[:-1] + edges[1:]) / 2
    return [
        Bar(number / BARS, round(float(height), 4), "#" + bytes(color).hex())
        for number, (height, color) in enumerate(zip(heights, scale.colors(middles), strict=True))
    ]
