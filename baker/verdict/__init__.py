"""The verdict on a clip: which intervals look right, known without any truth."""

from baker.verdict.doubt import Doubt, provenance_of
from baker.verdict.identity import FollowedOrgans
from baker.verdict.judge import find_doubts, judged

__all__ = ["Doubt", "FollowedOrgans", "find_doubts", "judged", "provenance_of"]
