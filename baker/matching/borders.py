"""Make the borders of organs that were found by shape alike over the series.

The border between an organ and its parent is found in each scan by itself. In one of them, a piece
of petiole or stem may belong to the leaf, which then shrinks in the next scan or comes off its
parent on the way. But plants do not grow so: tissue stays in the same organ.
"""

from collections import defaultdict
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Points, interpolate
from baker.segmentation.organ_entries import organ_entries

NEIGHBORS = 3  # points of a sample from which the geodesic distance of a point is interpolated


def align_borders(
    clouds: Sequence[NDArray[np.floating]],
    tracks: Sequence[NDArray[np.int64]],
    root_points: Sequence[int],
    protected: Collection[tuple[int, int]] = (),
) -> list[NDArray[np.int64]]:
    """Give to its parent what an organ has in one scan only, nearer to the plant base.

    Where an organ starts on the way from the plant base to its tip changes slowly, as both grow, so
    this is smoothed over the scans that show the organ. Organs only become shorter: towards the
    base, their borders might get beyond a fork.

    clouds, tracks, root_points: (N, 3) points of each aligned scan, their (N,) track numbers, and
    the index of the point at the plant base. protected: (scan, track) of organs to leave as they
    are. Returns the track numbers with the new borders.
    """
    organs = defaultdict[int, list[tuple[int, Points, Points, int]]](list)
    for k, scan in enumerate(map(organ_entries, clouds, tracks, root_points)):
        parents = scan.shares().argmax(axis=1)
        for organ, track in enumerate(scan.labels):
            own, parent = scan.organ == organ, scan.labels[parents[organ]]
            # Its scan, a sample of its points and their distances from the plant base, its parent.
            organs[track].append((k, scan.points[own], scan.distance[own], parent))
    aligned = list(map(np.copy, tracks))
    for track, present in organs.items():
        starts = np.array([d.min() / (d.max() or 1.0) for _, _, d, _ in present])
        borders = running_medians(starts)
        for i, (k, sample, distances, parent) in enumerate(present):
            if borders[i] > starts[i] and (k, track) not in protected:
                members = np.flatnonzero(tracks[k] == track)
                distance = interpolate(clouds[k][members], sample, distances, NEIGHBORS)
                aligned[k][members[distance < borders[i] * distances.max()]] = parent
    return aligned


def running_medians(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Running medians of three (n,) values, with the end-point rule of Tukey (1977).

    A trend stays as it is. Of the first value, that on a line through the next two medians, and
    the next median, the middle one is taken; likewise at the end. Two values stay as they are.
    """
    from scipy.ndimage import median_filter

    medians = median_filter(values, 3, mode="nearest")
    if len(values) > 2:
        for end, step in (0, 1), (-1, -1):
            inner, next_inner = medians[end + step], medians[end + 2 * step]
            medians[end] = np.median([values[end], inner, 3.0 * inner - 2.0 * next_inner])
    return medians
