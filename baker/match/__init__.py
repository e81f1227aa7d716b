"""Which segment becomes which from scan to scan (paper section 3.3), and the organs' tracks."""

from baker.match.greedy import PAPER, GreedyRules
from baker.match.match import Match, match_by_label
from baker.match.organs import IntervalOrgans, Organ, follow_organs
from baker.match.series import match_series

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
