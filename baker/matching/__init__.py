"""Which segment becomes which from scan to scan (paper section 3.3), and the organs' tracks."""

from baker.matching.hierarchical import PAPER, GreedyRules
from baker.matching.match import Match, match_by_label
from baker.matching.series import match_series
from baker.matching.tracks import IntervalOrgans, Organ, follow_organs

__all__ = [
    "PAPER",
    "GreedyRules",
    "IntervalOrgans",
    "Match",
    "Organ",
    "follow_organs",
    "match_by_label",
    "match_series",
]
