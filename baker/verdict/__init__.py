"""The verdict on a clip: which intervals look right, known without any truth."""

from baker.verdict.doubt import Doubt, provenance_of
from baker.verdict.identity import FollowedOrgans
from baker.verdict.judge import judged

__all__ = ["Doubt", "FollowedOrgans", "judged", "provenance_of"]
