"""What a bake says about its own film."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from baker import Options
from baker.pipeline import bake_with_survey
from baker.verdict.doubt import command_for, describe_verdict, verdict_provenance
from gclip import Clip
from traits.doubts import Doubt, doubts_of


@pytest.fixture
def clip(write_scans) -> Clip:
    return bake_with_survey([write_scans(days=range(5))], Options(align="none", up="z"))[0]


def test_a_clean_film_is_said_to_be_right(clip):
    assert describe_verdict(clip, []) == "All 4 intervals look right."


def test_what_is_wrong_is_named_by_time_the_worst_of_each_first(clip):
    doubts = [
        Doubt(3, 4, 2, "organ 2 tears", 2.0),
        Doubt(1, 2, 1, "organ 1 tears", 1.5),
        Doubt(3, 4, 1, "parts of organ 1 change places", 3.0),
    ]
    assert describe_verdict(clip, doubts) == (
        "2 of 4 intervals look right; day 1 to 2: organ 1 tears; "
        "day 3 to 4: parts of organ 1 change places, organ 2 tears."
    )


@pytest.mark.parametrize(("start", "day"), [(3.0, "3.5"), (19790.0, "19790.5")])
def test_the_command_shows_the_interval_half_way(start: float, day: str):
    doubt = Doubt(start, start + 1, 0, "it tears", 1.0)
    assert command_for(doubt, Path("my clips/x.gclip")) == f"play 'my clips/x.gclip' --day {day}"


def test_of_many_doubts_the_line_names_a_few(clip):
    doubts = [Doubt(k, k + 1, n, f"{n} tears", 1.0 + n) for k in range(4) for n in range(4)]
    line = describe_verdict(clip, doubts)
    assert line.startswith("None of 4 intervals looks right; day 0 to 1: 3 tears, 2 tears, and 2")
    assert line.endswith("; and 1 more interval.")


def test_dates_stay_whole(clip):
    scans = [replace(scan, date=f"2024-05-0{k + 1}") for k, scan in enumerate(clip.scans)]
    line = describe_verdict(replace(clip, scans=tuple(scans)), [Doubt(1, 2, 0, "it tears", 1.0)])
    assert line == "3 of 4 intervals look right; 2024-05-02 to 2024-05-03: it tears."


def test_the_clips_provenance_holds_the_verdict(clip, tmp_path):
    import gclip

    doubts = [Doubt(0, 1, 1, "organ 1 tears", 1.25, identity=True)]
    verdict = json.loads(json.dumps(verdict_provenance(clip, doubts)))
    judged = replace(clip, provenance={**clip.provenance, "verdict": verdict})
    judged.save(tmp_path / "x.gclip")
    assert list(doubts_of(gclip.open(tmp_path / "x.gclip"))) == doubts
    assert verdict["line"] == describe_verdict(clip, doubts)
