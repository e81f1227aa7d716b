"""Colours that tell organs apart."""

from __future__ import annotations

ROOT = (150, 124, 92)  # bark: the stem carries the picture without asking for attention


def organ_colors(count: int) -> list[tuple[int, int, int]]:
    """`count` sRGB colours for the tracks, the root's first.

    Ten colours that stay apart for colour-blind eyes (Petroff 2021), then 256 that are as
    different as they can be (Glasbey et al. 2007), over and over.
    """
    import cmap

    names = ["petroff10", "glasbey"]
    distinct = [stop.color for name in names for stop in cmap.Colormap(name).color_stops]
    rgb = [(int(c.rgba8.r), int(c.rgba8.g), int(c.rgba8.b)) for c in distinct]
    return [ROOT, *(rgb[i % len(rgb)] for i in range(count - 1))][:count]
