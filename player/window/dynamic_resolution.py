"""Adapts the number of movers and pixels to the speed of the machine while the view moves."""

import math
from dataclasses import dataclass

BUDGET = 1 / 60  # seconds that a frame may take while the view moves
FAST_SHARE = 0.4  # share of the budget below which a frame is fast enough for more detail
STEP, STEPS = 0.8, 3  # factor on width and height per level, and number of such levels
MIN_PIXELS = 400_000  # with fewer pixels the points, not the pixels, would dominate the time
MIN_MOVERS = 1_000_000  # fewer movers would hardly be faster
PATIENCE = 3  # consecutive slow or fast frames before the level changes


@dataclass(frozen=True)
class Detail:
    """How much detail of a picture to draw."""

    resolution: float = 1.0  #: factor on the window's width and height
    stride: int = 1  #: every n-th mover is drawn


class DynamicResolution:
    """Chooses the level of detail that the machine can draw within the budget.

    movers: largest number of movers in an interval. The first levels halve them, down to
            MIN_MOVERS; the following ones reduce the resolution.
    """

    def __init__(self, movers: int = 0) -> None:
        self._halvings = max(int(math.log2(max(movers, 1) / MIN_MOVERS)), 0)
        self._level = self._streak = 0

    def detail(self, size: tuple[int, int]) -> Detail:
        """The current level of detail for a framebuffer of `size` pixels."""
        halvings = min(self._level, self._halvings)
        min_resolution = math.sqrt(MIN_PIXELS / max(size[0] * size[1], 1))
        return Detail(min(max(STEP ** (self._level - halvings), min_resolution), 1.0), 2**halvings)

    def record_frame(self, seconds: float) -> None:
        """Adapt the level to the duration of a frame at the current level."""
        trend = (seconds > BUDGET) - (seconds < FAST_SHARE * BUDGET)
        self._streak = trend + (self._streak if trend * self._streak > 0 else 0)
        if abs(self._streak) == PATIENCE:
            self._level = min(max(self._level + trend, 0), self._halvings + STEPS)
            self._streak = 0
