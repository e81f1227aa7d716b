"""Fewer movers and pixels on slow machines while things move, and all of them at rest."""

import math
from dataclasses import dataclass

BUDGET = 1 / 60  # seconds that a picture may take while things move
ROOMY = 0.4  # share of the budget below which more detail is tried
STEP, STEPS = 0.8, 3  # share of width and height from level to level, and how many times at most
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

    movers: how many there are at most to draw at once. From level to level half of them are left
            out, as long as there are very many, and pixels after that.
    """

    def __init__(self, movers: int = 0) -> None:
        self._halvings = max(int(math.log2(max(movers, 1) / FEWEST)), 0)
        self._level = self._streak = 0

    def detail(self, size: tuple[int, int]) -> Detail:
        """For a framebuffer of `size` pixels."""
        halvings = min(self._level, self._halvings)
        least = math.sqrt(PLENTY / max(size[0] * size[1], 1))
        return Detail(min(max(STEP ** (self._level - halvings), least), 1.0), 2**halvings)

    def frame_took(self, seconds: float) -> None:
        """A picture at the present detail took so long."""
        verdict = (seconds > BUDGET) - (seconds < ROOMY * BUDGET)
        self._streak = verdict + (self._streak if verdict * self._streak > 0 else 0)
        if abs(self._streak) == PATIENCE:
            self._level = min(max(self._level + verdict, 0), self._halvings + STEPS)
            self._streak = 0
