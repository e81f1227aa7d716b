"""The verdict on a clip: which intervals look right, judged without knowing the true growth."""

from baker.verdict.doubt import Doubt, verdict_provenance
from baker.verdict.identity import FollowedOrgans
from baker.verdict.judge import judge_clip

__all__ = ["Doubt", "FollowedOrgans", "judge_clip", "verdict_provenance"]
