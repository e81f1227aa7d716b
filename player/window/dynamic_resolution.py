"""Keeps motion smooth on slow machines: fewer movers and pixels while things move, all of them at
rest.
"""

import math
from dataclasses import dataclass, replace

BUDGET = 1 / 60  # seconds that a picture may take while things move
ROOMY = 0.4  # share of the budget below which more detail is tried
LEVELS = (1.0, 0.8, 0.62, 0.48)  # shares of the window's width and height
PLENTY = 400_000  # pixels that are always drawn: below them it is the points that take the time
FEWEST = 1_000_000  # movers that are always drawn: fewer would not be much faster
PATIENCE = 3  # slow or fast pictures in a row before the level changes


@dataclass(frozen=True)
class Detail:
    """How much of a picture to draw."""

    pixels: float = 1.0  #: share of the window's width and height
    every: int = 1  #: of so many movers one


class DynamicResolution:
    """Chooses how much detail the machine can draw in time.

    movers: how many there are at most to draw at once. Where there are very many, half of them are
            left out, and half again, before pixels are.
    """

    def __init__(self, movers: int = 0) -> None:
        fewer = [Detail(1.0, 2**n) for n in range(1, 32) if movers / 2**n >= FEWEST]
        least = fewer[-1].every if fewer else 1
        self._ladder = [Detail(), *fewer, *(Detail(share, least) for share in LEVELS[1:])]
        self._level = 0
        self._slow = self._fast = 0

    def detail(self, size: tuple[int, int]) -> Detail:
        """For a framebuffer of `size` pixels."""
        least = math.sqrt(PLENTY / max(size[0] * size[1], 1))
        chosen = self._ladder[self._level]
        return replace(chosen, pixels=min(max(chosen.pixels, least), 1.0))

    def frame_took(self, seconds: float) -> None:
        """A picture at the present detail took so long."""
        self._slow = self._slow + 1 if seconds > BUDGET else 0
        self._fast = self._fast + 1 if seconds < ROOMY * BUDGET else 0
        if self._slow >= PATIENCE and self._level < len(self._ladder) - 1:
            self._level, self._slow = self._level + 1, 0
        elif self._fast >= PATIENCE and self._level > 0:
            self._level, self._fast = self._level - 1, 0
