"""What a finished bake says in the terminal."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from baker.report.summary import summary_lines, verdict_line
from baker.verdict.doubt import verdict_provenance
from gclip import Clip
from traits.doubts import Doubt


@pytest.fixture
def saved(baked, tmp_path) -> Clip:
    baked[0].save(tmp_path / "plant.gclip")
    return baked[0]


def summary(clip: Clip, folder, verbose: bool = False) -> str:
    path = folder / "plant.gclip"
    return "\n".join(summary_lines(clip, path, {"reading": 1.5}, "", verbose))


def with_marginal_error(clip: Clip, error: float) -> Clip:
    """The clip as if one transport plan had been solved so badly."""
    first = clip.intervals[0]
    segments = (replace(first.segments[0], marginal_error=error), *first.segments[1:])
    return replace(clip, intervals=(replace(first, segments=segments), *clip.intervals[1:]))


def test_scans_organs_and_the_file_are_named_and_no_solvers(saved, tmp_path):
    text = summary(saved, tmp_path)
    assert f"organs   {len(saved.track_table)};" in text
    assert str(tmp_path / "plant.gclip") in text
    for word in ("solver", "movers", "marginal", "transport"):
        assert word not in text
        assert word in summary(saved, tmp_path, verbose=True) or word == "transport"


def test_an_inexact_transport_is_put_in_terms_of_the_film(saved, tmp_path):
    pairs = sum(len(interval.segments) for interval in saved.intervals)
    text = summary(with_marginal_error(saved, 0.08), tmp_path)
    assert f"inexact for 1 of {pairs} segment pairs: up to 4% of a segment's points" in text
    assert "inexact for" not in summary(with_marginal_error(saved, 1e-4), tmp_path)


def test_the_last_line_is_the_verdict_and_where_to_look(saved, tmp_path):
    assert verdict_line(saved, tmp_path / "x.gclip") == "All 2 intervals look right."
    assert verdict_line(saved, tmp_path / "x.gclip", ["up", "frame"]) == (
        "All 2 intervals look right. First check what is said above about: up, frame."
    )
    doubts = [Doubt(0.0, 2.0, 1, "leaf 1 tears", 2.0)]
    provenance = {**saved.provenance, "verdict": verdict_provenance(saved, doubts)}
    assert verdict_line(replace(saved, provenance=provenance), Path("x.gclip")) == (
        "1 of 2 intervals looks right; day 0 to 2: leaf 1 tears. Look: play x.gclip --day 1"
    )
