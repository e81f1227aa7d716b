"""Organs of scans, what was merged, why it was matched."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from baker import Options
from baker.matching.match import Merge
from baker.pipeline import bake_recorded
from baker.report.matching import organ_distances, reasons
from baker.report.organs import absorbed_organs, merged_segments, organs_of_scans

PLAIN = Options(align="none", up="z", workers=1)


@pytest.fixture(params=["auto", "ignore"])
def bake(request, write_scans):
    """A bake by label, and one that segments at forks and merges."""
    return bake_recorded([write_scans(days=range(4))], replace(PLAIN, labels=request.param))


def test_every_point_has_its_organ(bake):
    clip, record = bake
    for frame, scan, k in zip(record.keyframes, organs_of_scans(record), range(4), strict=True):
        found, counts = np.unique(scan.points, return_counts=True)
        assert dict(zip(found.tolist(), counts.tolist(), strict=True)) == scan.counts
        assert len(scan.points) == len(frame.positions)
        assert len(scan.segments) == len(record.hierarchies[k].segments)
        shown = set(clip.at(clip.times[k]).tracks.tolist())  # and the next scan's new organs
        assert set(scan.counts) <= shown


def test_organs_that_merged_away_are_part_of_one_that_is_there(bake):
    _, record = bake
    scans = organs_of_scans(record)
    for k in range(3):
        for organ, whole in absorbed_organs(record, k).items():
            assert organ not in scans[k].counts
            assert whole in scans[k].counts
        for merge in merged_segments(record, k):
            assert merge.after < merge.before
            assert merge.into in (
                *record.organs[k].first.values(),
                *record.organs[k].second.values(),
            )


def test_a_merge_names_the_organ_it_became(write_scans):
    """The same bake as if leaf 1 of the second scan had been cut in two segments."""
    _, record = bake_recorded([write_scans()], PLAIN)
    (merged, _), whole = record.matches, record.hierarchies[1]
    leaf = whole.labels.index(1)
    half = len(whole.segments[leaf]) // 2
    cut = replace(
        whole,
        segments=(
            *(m[:half] if s == leaf else m for s, m in enumerate(whole.segments)),
            whole.segments[leaf][half:],
        ),
        labels=(*whole.labels, None),
        parents=(*whole.parents, leaf),
    )
    merge = Merge(side=1, head=leaf, child=len(whole.segments), before=2.0, after=1.0)
    edited = replace(
        record,
        hierarchies=(record.hierarchies[0], cut, record.hierarchies[2]),
        matches=(replace(merged, merges=(merge,)), record.matches[1]),
    )
    (found,) = merged_segments(edited, 0)
    organ = record.organs[0].second[leaf]
    assert (found.scan, found.are_organs, found.into, found.child) == (1, False, organ, merge.child)
    assert organs_of_scans(edited)[1].segments[-1] == organ


def test_a_leaf_is_matched_to_the_nearest_and_born_on_the_stem(write_scans):
    clip, record = bake_recorded([write_scans()], PLAIN)
    scan, distances = organs_of_scans(record)[0], organ_distances(record, 0)
    found = {r.pair.track: r for r in reasons(clip, record, 0, scan, distances)}
    stem, leaf, new = (
        next(t.id for t in clip.track_table if t.name == f"label {n}") for n in range(3)
    )
    assert found[leaf].labels == (1, 1)
    assert found[leaf].distance < found[leaf].nearest_other[1]
    assert distances[leaf][leaf] == found[leaf].distance
    assert (found[new].pair.event, found[new].parent) == ("birth", stem)
    assert np.linalg.norm(found[new].attachment - [0, 0, 6.0]) < 1.0


@pytest.mark.parametrize("options", [{}, {"bud": 30}, {"paper": True, "bud": 1}, {"paper": True}])
def test_attachment_points_are_where_the_movers_unfold(write_scans, options):
    clip, record = bake_recorded([write_scans()], replace(PLAIN, **options))
    scan, distances = organs_of_scans(record)[0], organ_distances(record, 0)
    found = reasons(clip, record, 0, scan, distances)
    births = [reason for reason in found if reason.pair.event == "birth"]
    assert births
    frame = clip.at(clip.times[0])
    for birth in births:
        unfolding = frame.positions[frame.tracks == birth.pair.track]
        middle = np.unique(unfolding.round(4), axis=0).mean(axis=0)
        np.testing.assert_allclose(birth.attachment, middle, atol=1e-3)


def test_many_segments_are_not_all_compared(write_scans, monkeypatch):
    monkeypatch.setattr("baker.report.matching.MAX_PAIRS", 3)
    clip, record = bake_recorded([write_scans()], PLAIN)
    assert organ_distances(record, 0) == {}
    found = reasons(clip, record, 0, organs_of_scans(record)[0], {})
    assert len(found) == len(clip.intervals[0].segments)
