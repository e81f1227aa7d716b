"""What bakes of real scans say of themselves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from baker import Options, bake
from baker.verdict.doubt import doubts_in
from gclip import Clip
from tests.real.series import present


def test_the_example_is_what_its_verdict_says(example: Clip) -> None:
    verdict = example.provenance["verdict"]
    assert verdict["line"].startswith("All ") == (not verdict["doubts"])


@pytest.mark.parametrize("name", present("maize_control_plant1"))
def test_a_leaf_that_turns_round_is_named_and_nothing_else(
    series: Callable[[str], Path], name: str
) -> None:
    """From day 7 to 8 the lowest leaf's base and tip change places, as one sees in the film."""
    clip = bake([series(name)], Options(align="none", workers=2))
    assert [(doubt.start, doubt.track, doubt.identity) for doubt in doubts_in(clip)] == [
        (7.0, 1, False)
    ]
    assert clip.provenance["verdict"]["line"] == (
        "7 of 8 intervals look right; day 7 to 8: the tip and the base of label 1 change places."
    )


@pytest.mark.parametrize("name", present("tobacco_control_plant1"))
def test_organs_that_are_mixed_up_are_doubtful(series: Callable[[str], Path], name: str) -> None:
    """With labels ignored, four organs are taken for others between days 8 and 12."""
    clip = bake([series(name)], Options(align="none", labels="ignore", workers=2))
    doubtful = {doubt.start for doubt in doubts_in(clip) if doubt.identity}
    assert {8.0, 10.0} <= doubtful
