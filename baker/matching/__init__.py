"""Match the segments of successive scans (section 3.3 of the paper), and track organs."""

from baker.matching.labels import LabelUse, follow_labels, label_policy
from baker.matching.match import Match, Organ, follow_organs, match_series

__all__ = [
    "LabelUse",
    "Match",
    "Organ",
    "follow_labels",
    "follow_organs",
    "label_policy",
    "match_series",
]
