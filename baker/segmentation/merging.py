"""Organs that touch along most of their length are one: a sheet cut in strips, a stem split open.

A real organ touches what bears it at its base, and others here and there. Sparse or patchy scans
let a blade or stem look forked where it only has a gap.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.voxel_sampling import EvenSample

SHARE = 0.4  # of an organ's points beyond its base: so many touch the organ that it is part of
REACH = 3.0  # points touch that are so near, in spacings
BASE = 2.0  # length of the base where any organ touches another, in level sets


def join_touching(sample: EvenSample, organ: NDArray[np.intp]) -> NDArray[np.intp]:
    """(n,) organs of the sample's points, strips joined to what they are strips of.

    organ: (n,) numbers from 0, the stem, on. The smallest are joined first.
    """
    edges = sample.graph.tocoo()
    close = edges.data <= REACH * sample.spacing
    one, other = edges.row[close], edges.col[close]
    ends = np.concatenate([[one, other], [other, one]], axis=1)
    organ = organ.copy()
    while True:
        begin = np.full(organ.max() + 1, np.inf)
        np.minimum.at(begin, organ, sample.distance)
        far = sample.distance > begin[organ] + BASE * sample.thickness
        beyond = np.bincount(organ[far], minlength=len(begin))
        touching = ends[:, far[ends[0]] & (organ[ends[0]] != organ[ends[1]])]
        points = np.unique(np.stack([touching[0], organ[touching[1]]]), axis=1)
        pairs, counts = np.unique(
            np.stack([organ[points[0]], points[1]]), axis=1, return_counts=True
        )
        strips = counts > SHARE * beyond[pairs[0]]
        strips &= beyond[pairs[0]] <= np.bincount(organ, minlength=len(begin))[pairs[1]]
        strips &= pairs[0] != 0
        if not strips.any():
            return organ
        smallest = np.flatnonzero(strips)[np.argmin(beyond[pairs[0, strips]])]
        organ[organ == pairs[0, smallest]] = pairs[1, smallest]
