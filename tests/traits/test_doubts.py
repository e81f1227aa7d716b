"""What a bake doubts is not sure in the table of traits."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

import pytest

from baker import Options, bake
from gclip import Clip
from grow.series import Plan, write_series
from traits import measure_days, write_table
from traits.doubts import Doubt, doubts_of
from traits.table import NamedPlant


def test_motion_matters_between_its_scans_and_identity_from_the_first_one_on():
    motion, identity = (Doubt(1.0, 2.0, 0, "", 1.0, which) for which in (False, True))
    times = (0.5, 1.0, 1.5, 2.0, 3.0)
    assert [motion.concerns(t) for t in times] == [False, False, True, False, False]
    assert [identity.concerns(t) for t in times] == [False, False, True, True, True]


@pytest.fixture(scope="module")
def grown(tmp_path_factory: pytest.TempPathFactory) -> Clip:
    folder = tmp_path_factory.mktemp("maize") / "scans"
    write_series(Plan("maize", seed=0, scans=3, days=14, points=(500, 1000)), folder)
    return bake([folder], Options(align="none", workers=1))


@pytest.fixture
def judged(grown: Clip):
    """The clip with one doubt of organ 1 in its second interval."""

    def with_doubt(identity: bool) -> Clip:
        start, end = grown.times[1:3]
        doubt = {"start": start, "end": end, "track": 1, "what": "", "identity": identity}
        return replace(grown, provenance={"verdict": {"line": "", "doubts": [doubt]}})

    return with_doubt


def sure_of(clip: Clip) -> dict[tuple[str, ...], str]:
    file = io.StringIO()
    write_table(file, NamedPlant(clip, "p"), measure_days(clip))
    keys = ("track", "trait", "state", "time", "start", "end")
    rows = csv.DictReader(io.StringIO(file.getvalue()))
    return {tuple(row[key] for key in keys): row["sure"] for row in rows}


def test_only_what_the_doubt_concerns_is_no_longer_sure(grown: Clip, judged):
    before, start, end = sure_of(replace(grown, provenance={})), *grown.times[1:3]
    for identity in (False, True):
        after = sure_of(judged(identity))
        lost = {key for key in before if before[key] == "yes" and after[key] == "no"}
        assert {key for key in before if before[key] != after[key]} == lost
        assert {track for track, *_ in lost} == {"1"}
        states = {state for _, _, state, *_ in lost}
        assert states == ({"scan", "between", "rate"} if identity else {"between"})
        for _, _, state, time, _, until in lost:
            assert float(until if state == "rate" else time) > start
            assert identity or float(time) < end


@pytest.mark.parametrize(
    "verdict",
    [None, "fine", {}, {"doubts": 3}, {"doubts": [{"start": "1"}]}, {"doubts": [{"start": 0.5}]}],
)
def test_a_verdict_of_another_form_is_none(grown: Clip, verdict):
    assert doubts_of(replace(grown, provenance={"verdict": verdict})) == ()


def test_a_doubt_of_no_interval_is_none(grown: Clip):
    doubt = {"start": 0.123, "end": 1e300, "track": 1, "what": "", "identity": True}
    assert doubts_of(replace(grown, provenance={"verdict": {"doubts": [doubt]}})) == ()
