"""How far a new organ has unfolded at the middle of the interval that it is born in.

What a scan doesn't show may appear at any time before the next one, so at mid-interval it has half
of its size in the mean. But an organ of a few points may have been there all along, too small to be
seen: then it had more.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.organ_attachments import Attachment
from baker.interpolation.timing import Timing
from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT

MIN_POINTS_SEEN = 10  # of an organ, from which on a scan shows it

Points = NDArray[np.floating]


@dataclass(frozen=True)
class Birth:
    """How an organ unfolds from its attachment point."""

    attachment: NDArray[np.float64]  # (3,), at the end of the interval
    size: float  # at mid-interval, as a share of that at the end
    parent: Timing | None = None  # of the organ that it grows on, where that doesn't move evenly

    def shift(self, start: Points, end: Points) -> NDArray[np.floating]:
        """(N, 3) how far movers between these points are from the middle of their paths.

        At mid-interval each is `size` of the distance from the attachment point to its end, and the
        attachment point where its parent is.
        """
        unfolding = (self.size - 0.5) * (end - self.attachment)
        if self.parent is not None:
            unfolding = unfolding + self.parent.shift(start, self.attachment)
        return unfolding


def births(
    cloud: NDArray[np.floating],
    attachments: Mapping[int, Attachment],
    match: Match,
    organs: IntervalOrgans,
    timings: Mapping[int, Timing],
) -> dict[int, Birth]:
    """How each organ that is born in an interval unfolds; a whole new branch does so as one piece.

    cloud: (N, 3) points of the second scan; attachments: of its segments; timings: of the
    interval's organs.
    """

    segments, parents = match.second.segments, match.second.parents
    new, found = set(match.births), dict[int, Birth]()
    for segment in match.second.from_the_root():
        if segment not in new or not len(segments[segment]):
            continue
        parent = parents[segment]
        if parent in new and organs.second[parent] in found:
            found[organs.second[segment]] = found[organs.second[parent]]
            continue
        own = cloud.take(segments[segment], axis=0)
        if segment in attachments:
            point = attachments[segment].point
        else:  # under an empty root: as near to the middle of the plant as it comes
            point = own[np.argmin(((own - np.median(cloud, axis=0)) ** 2).sum(axis=1))]
        # It may have had any size at which it is not seen: half of that in the mean.
        found[organs.second[segment]] = Birth(
            point.astype(np.float64),
            0.5 + min(1.0, (MIN_POINTS_SEEN / len(own)) ** 0.5) / 4,
            timings.get(organs.second[parent]) if parent != NO_PARENT else None,
        )
    return found
