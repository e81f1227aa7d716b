"""Colours blend in linear light, as light itself does (IEC 61966-2-1, sRGB)."""

import numpy as np
from numpy.typing import NDArray


def srgb_to_linear(srgb: NDArray[np.floating]) -> NDArray[np.floating]:
    """sRGB in [0, 1] to linear light in [0, 1]."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(linear: NDArray[np.floating]) -> NDArray[np.floating]:
    """Linear light in [0, 1] to sRGB in [0, 1]."""
    return np.where(
        linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055
    )


def blend_srgb(start: NDArray[np.uint8], end: NDArray[np.uint8], share: float) -> NDArray[np.uint8]:
    """Blend (N, 4) uint8 sRGB and alpha from start to end; the ends themselves come out exactly."""
    if share <= 0.0:
        return np.asarray(start)
    if share >= 1.0:
        return np.asarray(end)
    light = srgb_to_linear(np.arange(256) / 255.0)
    blended = np.empty(start.shape, np.uint8)
    blended[:, :3] = np.round(
        255.0 * linear_to_srgb((1.0 - share) * light[start[:, :3]] + share * light[end[:, :3]])
    )
    blended[:, 3] = np.round((1.0 - share) * start[:, 3] + share * end[:, 3])
    return blended
