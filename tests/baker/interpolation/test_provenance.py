"""What a clip says of itself: its packages, and its organs as tracks."""

from dataclasses import replace
from pathlib import Path

from baker import bake
from baker.interpolation.provenance import in_order, organ_order, software
from baker.matching import Organ


def test_open3d_is_named_where_its_numbers_are_in_the_clip() -> None:
    usual = {"numpy", "scipy", "numba"}
    assert set(software()["packages"]) == usual
    assert set(software([Path("a.ply"), Path("b.xyz")])["packages"]) == usual
    assert set(software([Path("a.ply"), Path("b.obj.gz")])["packages"]) == {*usual, "open3d"}
    assert set(software([Path("a.ply")], outliers=2.0)["packages"]) == {*usual, "open3d"}


def test_tracks_in_another_order_are_the_same_organs(write_scans):
    clip = bake([write_scans(days=(0, 1, 2, 3))], align="none", up="z", paths="straight")
    doubt = {"track": 2, "what": "leaf 2 tears"}
    clip.provenance["verdict"]["doubts"] = [doubt]
    *others, last = clip.track_table
    clip = replace(clip, track_table=(*others, replace(last, parent=1)))
    other = in_order(clip, [0, 3, 1, 2])
    assert [track.name for track in other.track_table] == ["stem", "leaf 3", "leaf 1", "leaf 2"]
    assert [track.id for track in other.track_table] == [0, 1, 2, 3]
    assert other.provenance["verdict"]["doubts"] == [{"track": 3, "what": "leaf 2 tears"}]

    def names(clip, ids):
        return [clip.track_table[track].name for track in ids]

    for before, after in zip(clip.intervals, other.intervals, strict=True):
        assert names(clip, before.tracks) == names(other, after.tracks)
        pairs = [one.track for one in before.segments], [one.track for one in after.segments]
        assert names(clip, pairs[0]) == names(other, pairs[1])
    parents = [(t.name, t.parent and names(clip, [t.parent])) for t in clip.track_table]
    assert sorted(parents, key=str) == sorted(
        [(t.name, t.parent and names(other, [t.parent])) for t in other.track_table], key=str
    )


def test_organs_go_by_appearance_and_then_from_the_lowest_on():
    organs = [Organ(None, None, 0, 2), Organ(1, 0, 1, 2), Organ(2, 0, 0, 2), Organ(3, 0, 0, 2)]
    assert organ_order(organs, {1: 1.0, 2: 9.0, 3: 5.0}) == [0, 3, 2, 1]
    assert organ_order(organs, {}) == [0, 2, 3, 1]
