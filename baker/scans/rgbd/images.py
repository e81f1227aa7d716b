"""Read colours, depth, labels and masks from image files."""

import re
import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError

FORMATS = ("PNG", "TIFF", "JPEG", "BMP", "PPM")  # for others, Pillow may run external programs
MAX_PIXELS_PER_BYTE = 8 * 1032  # of PNG: DEFLATE packs at most 1032 bytes into one
MAX_LABELS = 256  # an image with more was smoothed or compressed with loss


def read_depth(path: Path, unit: float) -> NDArray[np.float64]:
    """Read depth (H, W) in mm along the camera's axis, 0 where the camera measured nothing.

    unit: mm of one count of depth.
    """
    return np.maximum(read_pixels(path, "I.*"), 0).astype(np.float64) * unit


def read_labels(path: Path) -> NDArray[np.int64]:
    """Read labels (H, W): the value of a grey or palette pixel, 0xRRGGBB of a coloured pixel.

    Transparent pixels are 0. Raises InputError for more than `MAX_LABELS` distinct labels.
    """
    labels = _numbers(read_pixels(path, "I.*|1|L|P", "RGBA"))
    if (distinct := len(np.unique(labels))) > MAX_LABELS:
        needed = "a label image needs one flat colour for each organ, saved without loss"
        raise InputError(f"'{path}' has {distinct} distinct colours; {needed}.")
    return labels


def read_mask(path: Path) -> NDArray[np.bool_]:
    """Read a mask (H, W), which is True where a channel other than opacity is not 0."""
    return _numbers(read_pixels(path, "I.*", "RGBA")) != 0


def _numbers(pixels: NDArray) -> NDArray[np.int64]:
    """Convert (H, W) or (H, W, 4) pixels to one number each: the value, or 0xRRGGBB."""
    if pixels.ndim == 2:
        return pixels.astype(np.int64)
    red, green, blue, alpha = np.moveaxis(pixels.astype(np.int64), -1, 0)
    return np.where(alpha > 0, (red << 16) + (green << 8) + blue, 0)


def read_pixels(path: Path, accepted: str, fallback: str | None = None) -> NDArray:
    """Read an image's pixels, converted to the mode `fallback` unless its mode matches `accepted`.

    accepted: a regular expression of Pillow's modes. Raises InputError for a damaged image, or one
    of another mode if there is no fallback.
    """
    from PIL import Image

    # From memory, so that Pillow can't allocate the size that a damaged chunk announces.
    content = path.read_bytes()
    try:
        with (
            warnings.catch_warnings(action="ignore"),
            Image.open(BytesIO(content), formats=FORMATS) as image,
        ):
            pixels = image.width * image.height
            if image.format == "PNG" and pixels > MAX_PIXELS_PER_BYTE * len(content):
                raise ValueError(f"its {len(content)} bytes can't hold so many pixels")
            mode = image.mode if re.fullmatch(accepted, image.mode) else fallback
            if mode is None:
                needed = "a depth image has one channel of 16 bits a pixel"
                raise ValueError(f"{needed}, not the kind '{image.mode}'")
            return np.array(image.convert(mode))
    except Exception as error:
        reason = " ".join(re.sub("<.*>", "", str(error)).split()).rstrip(".")
        what = f"'{path}' can't be read as an image ({', '.join(FORMATS)})"
        raise InputError(f"{what}: {reason}.") from error
