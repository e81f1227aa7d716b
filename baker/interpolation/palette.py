"""Colours that tell organs apart."""

from __future__ import annotations

from colorsys import hls_to_rgb

STEM = (122, 158, 72)  # a plant's own green: the stem carries the picture without asking for it
GOLDEN_ANGLE = 0.381966  # of a turn: neighbours in age get hues that lie far apart
FIRST_HUE = 0.095


def organ_colors(count: int) -> list[tuple[int, int, int]]:
    """`count` sRGB colours for the tracks, the root's first.

    Hues go round by the golden angle; each round is a little lighter or darker than the last one.
    """
    return [STEM, *(_color(index) for index in range(count - 1))][:count]


def _color(index: int) -> tuple[int, int, int]:
    hue = (FIRST_HUE + GOLDEN_ANGLE * index) % 1.0
    lightness = (0.56, 0.66, 0.46)[index // 8 % 3]
    red, green, blue = (round(255 * value) for value in hls_to_rgb(hue, lightness, 0.72))
    return red, green, blue
