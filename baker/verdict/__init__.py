"""The verdict on a clip: which intervals look right, judged without knowing the true growth."""

from baker.verdict.judge import judge_clip

__all__ = ["judge_clip"]
