"""Compile the functions that measure traits: `python -m traits.compile`."""

import numpy as np

from traits.smooth import fit_patches, noise_of, smoothed
from traits.surface import surface_of


def measure_smallest() -> None:
    """Measure an organ of a few points, which calls every compiled function."""
    points = np.random.default_rng(0).random((50, 3))
    patches = fit_patches(points, points)
    surface_of(smoothed(patches, noise_of({0: patches}).usual).points)


if __name__ == "__main__":
    measure_smallest()
    print("The loops of traits are compiled.")
