"""Saves what a window shows as a picture."""

from __future__ import annotations

import re
from itertools import count
from pathlib import Path


def save_screenshot(pixels: bytes, size: tuple[int, int], title: str) -> str:
    """Write RGB pixels, bottom row first, into a new PNG file in the working folder.

    Its name comes from `title`, of which only letters, digits, ".", "_" and "-" are kept; no file
    is ever overwritten. Returns one sentence for the user: what was saved, or why nothing was.
    """
    from PIL import Image

    stem = re.sub(r"[^\w.-]+", "-", title).strip("-.")[:100] or "plant"
    names = (f"{stem}.png" if n == 1 else f"{stem}-{n}.png" for n in count(1))
    path = next(path for path in map(Path, names) if not path.exists())
    picture = Image.frombytes("RGB", size, pixels).transpose(Image.Transpose.FLIP_TOP_BOTTOM)
    try:
        picture.save(path)
    except OSError as error:
        return f"The screenshot can't be saved here: {error.strerror or error}."
    return f"Saved {path}"
