"""Which segments matching merged, told by the organs that they were and became."""

from __future__ import annotations

from dataclasses import dataclass

from baker.pipeline import BakeRecord
from baker.segmentation.hierarchy import Hierarchy


@dataclass(frozen=True)
class Joined:
    """A segment merged with its parent, because that brought the match nearer.

    scan:   number of the scan.
    known:  whether `head` and `child` are organs already; else they are segments, numbered as the
            scan was segmented.
    into:   the organ that they are now together, that of the larger part.
    before, after: distance of the match, in the scans' unit.
    """

    scan: int
    known: bool
    head: int
    child: int
    into: int
    before: float
    after: float


def joined(record: BakeRecord, interval: int) -> list[Joined]:
    """What was merged for an interval's match, in the order of merging."""
    match, named = record.matches[interval], record.organs[interval]
    found = []
    for merge in match.merges:
        head, child, gain = merge.head, merge.child, (merge.before, merge.after)
        if merge.side == 1:
            into = named.second[_home(record.hierarchies[interval + 1], head, match.second)]
            found.append(Joined(interval + 1, False, head, child, into, *gain))
        elif interval == 0:
            into = named.first[_home(record.hierarchies[0], head, match.first)]
            found.append(Joined(0, False, head, child, into, *gain))
        else:
            organs = record.organs[interval - 1].second
            into = named.first[_home(record.matches[interval - 1].second, head, match.first)]
            found.append(Joined(interval, True, organs[head], organs[child], into, *gain))
    return found


def absorbed(record: BakeRecord, interval: int) -> dict[int, int]:
    """Organs that ended the interval before this one and are part of another from here on."""
    if interval == 0:
        return {}
    before, named = record.matches[interval - 1].second, record.organs[interval - 1].second
    after = record.matches[interval].first
    now = record.organs[interval].first
    homes = {organ: now[_home(before, segment, after)] for segment, organ in named.items()}
    return {organ: home for organ, home in homes.items() if organ not in now.values()}


def _home(before: Hierarchy, segment: int, after: Hierarchy) -> int:
    """The segment that `segment` is part of, once some have been merged."""
    members = before.segments[segment]
    if not len(members):
        return after.root
    return next(s for s, own in enumerate(after.segments) if members[0] in own)
