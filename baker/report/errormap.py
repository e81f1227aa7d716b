"""The error of reconstructed scans in colours, blue to red (the paper's Figure 13)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.report.verification import HoldoutError

COLORMAP = "turbo"  # blue to red, and unlike "jet" even in between (Mikhailov 2019)
COLORMAP_RANGE = 0.08, 0.96  # the part of it that is neither black nor purple
SCALE_QUANTILE = 0.995  # share of all points that the scale covers
LEGEND_STEPS = 24


@dataclass(frozen=True)
class ErrorScale:
    """Distances from 0 to `top`, in the unit cube, are blue to red; larger ones are red too."""

    top: float

    @classmethod
    def of(cls, errors: Sequence[HoldoutError]) -> ErrorScale:
        """One scale for all scans left out; the few largest errors don't wash out the others."""
        distances = np.concatenate([error.distances for error in errors])
        return cls(max(float(np.quantile(distances, SCALE_QUANTILE)), 1e-9))

    def colors(self, distances: NDArray[np.floating]) -> NDArray[np.uint8]:
        """(N, 3) uint8 sRGB of (N,) distances."""
        import cmap

        share = np.clip(np.asarray(distances, float) / self.top, 0.0, 1.0)
        rgba = cmap.Colormap(COLORMAP)(np.interp(share, (0.0, 1.0), COLORMAP_RANGE))
        return np.round(255.0 * np.atleast_2d(rgba)[:, :3]).astype(np.uint8)

    @property
    def legend(self) -> list[str]:
        """The colours from 0 to `top` as "#rrggbb"."""
        return ["#" + bytes(c).hex() for c in self.colors(np.linspace(0, self.top, LEGEND_STEPS))]
