"""The whole bake on a small plant: what holds for every clip."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker import InputError, Options, bake
from gclip import Motion

PLAIN = Options(align="none", up="z", workers=1)


def farthest_apart(a: np.ndarray, b: np.ndarray) -> float:
    """Hausdorff distance of two point sets."""
    return max(cKDTree(a).query(b)[0].max(), cKDTree(b).query(a)[0].max())


@pytest.mark.parametrize(
    "options",
    [
        PLAIN,
        replace(PLAIN, labels="independent"),
        replace(PLAIN, labels="ignore"),
        replace(PLAIN, transport="whole"),
        replace(PLAIN, paper=True),
        replace(PLAIN, precision="float32"),
        replace(PLAIN, root="virtual"),
    ],
    ids=["default", "independent", "thin", "whole", "paper", "float32", "virtual root"],
)
def test_scans_come_back_exactly(write_scans, read_points, options):
    folder = write_scans()
    clip = bake([folder], options)
    for k, time in enumerate(clip.times):
        truth = read_points(folder / f"day{k:02d}.txt")
        assert farthest_apart(clip.at(time).positions, truth) < 1e-3


@pytest.mark.parametrize("decay", ["fall", "fade", "remove"])
def test_a_lost_organ_decays_as_asked(write_scans, read_points, decay):
    folder = write_scans(days=(1, 2, 3), without=1, gone=2)
    clip = bake([folder], replace(PLAIN, decay=decay))
    assert [g.motion for g in clip.intervals[1].groups] == [Motion.MOVE, Motion(decay)]
    for k, time in enumerate(clip.times):
        truth = read_points(folder / f"day{k:02d}.txt")
        assert farthest_apart(clip.at(time).positions, truth) < 1e-3
    lost = next(t for t in clip.track_table if t.lost is not None)
    assert (lost.name, lost.lost) == ("leaf 1", 2.0)
    if decay == "fall":
        ground = min(read_points(f)[:, 2].min() for f in folder.iterdir())
        litter = clip.at(2.0).litter
        assert np.allclose(litter.positions[:, 2], ground, atol=1e-3)


def test_an_organ_that_comes_back_fades_and_does_not_fall(write_scans):
    folder = write_scans(days=(1, 2, 3))
    hidden = np.loadtxt(folder / "day01.txt")
    np.savetxt(folder / "day01.txt", hidden[hidden[:, 3] != 1], fmt="%.4f")
    clip = bake([folder], PLAIN)
    assert [g.motion for g in clip.intervals[0].groups] == [Motion.MOVE, Motion.FADE]
    (track,) = [t for t in clip.track_table if t.name == "leaf 1"]
    assert track.lost is None
    assert clip.at(2.0).litter is None


def test_sinkhorn_stops_where_it_is_asked_to(write_scans):
    folder, sinkhorn = write_scans(), replace(PLAIN, transport="sinkhorn")
    early, late = (
        bake([folder], replace(sinkhorn, iterations=most, tolerance=1e-6)) for most in (1, 5000)
    )
    errors = [
        max(pair.marginal_error for interval in clip.intervals for pair in interval.segments)
        for clip in (early, late)
    ]
    assert errors[0] > 10 * errors[1]


def test_every_point_moves_and_movers_are_few(write_scans):
    clip = bake([write_scans()], replace(PLAIN, even=0.0))
    for interval, first, second in zip(clip.intervals, clip.scans, clip.scans[1:], strict=False):
        buds = sum(100 for pair in interval.segments if pair.event == "birth")
        assert max(first.points, second.points) <= len(interval)
        assert len(interval) <= first.points + second.points + buds
        for pair in interval.segments:
            assert pair.movers <= pair.start_points + pair.end_points
            assert pair.marginal_error < 1e-9
            assert pair.solver


def test_new_leaves_unfold_from_where_they_attach(write_scans):
    clip = bake([write_scans()], PLAIN)
    born = [t for t in clip.track_table if t.born > 0]
    assert [t.name for t in born] == ["leaf 2", "leaf 3"]
    for track in born:
        assert clip.track_table[track.parent].name == "stem"
        interval = next(i for i, t in enumerate(clip.times[1:]) if t == track.born)
        frame = clip.at(clip.times[interval] + 1e-6)
        attachment = [0, 0, 2.0 + 2 * int(track.name.split()[1])]
        apart = np.linalg.norm(frame.positions[frame.tracks == track.id] - attachment, axis=1)
        assert apart.max() < 1.5


def test_the_same_input_gives_the_same_bytes(write_scans, tmp_path):
    folder = write_scans()
    for name, workers in (("a", 1), ("b", 1), ("c", 2)):
        bake([folder], replace(PLAIN, workers=workers)).save(tmp_path / f"{name}.gclip")
    a, b, c = ((tmp_path / f"{name}.gclip").read_bytes() for name in "abc")
    assert a == b == c


def test_the_reversed_series_gives_the_reversed_motion(write_scans):
    options = replace(PLAIN, even=0.0)
    forward = bake([write_scans(name="forward")], options)
    backward = bake([write_scans(name="backward", reverse=True)], options)
    last = forward.times[-1]
    shared = {"stem", "leaf 1"}  # there in all scans: matched, never born or lost
    for day in (0.25, 0.5, 1.3):
        clouds = []
        for clip, time in ((forward, day), (backward, last - day)):
            frame = clip.at(time)
            ids = [t.id for t in clip.track_table if t.name in shared]
            clouds.append(frame.positions[np.isin(frame.tracks, ids)])
        # Where an organ is born one mover more may span the gap to it, and none where it is lost.
        ahead, back = cKDTree(clouds[1]).query(clouds[0])[0], cKDTree(clouds[0]).query(clouds[1])[0]
        assert np.sort(ahead)[-2] < 0.02
        assert back.max() < 0.02


def test_shuffled_labels_give_the_same_organs(write_scans):
    named = bake([write_scans(name="named")], PLAIN)
    shuffled = bake([write_scans(name="shuffled", labels="shuffled")], PLAIN)
    assert [t.born for t in shuffled.track_table] == [t.born for t in named.track_table]
    for day in (0.5, 1.5):
        a, b = named.at(day), shuffled.at(day)
        _, nearest = cKDTree(b.positions).query(a.positions)
        assert np.mean(b.tracks[nearest] == a.tracks) > 0.97


def test_an_organ_keeps_its_track_through_the_series(write_scans):
    clip = bake([write_scans(days=(0, 1, 2, 3))], PLAIN)
    leaf = next(t.id for t in clip.track_table if t.name == "leaf 1")
    base = [0, 0, 4.0]
    reach = []
    for day in (0.5, 1.5, 2.5):
        frame = clip.at(day)
        reach.append(np.linalg.norm(frame.positions[frame.tracks == leaf] - base, axis=1).max())
    assert reach == sorted(reach)


def test_provenance_tells_options_and_inputs_but_no_paths(write_scans):
    folder = write_scans()
    clip = bake([folder], PLAIN)
    assert [entry["name"] for entry in clip.provenance["inputs"]] == [s.name for s in clip.scans]
    assert clip.provenance["options"]["align"] == "none"
    assert str(folder) not in repr(clip.provenance)


def test_labels_asked_for_but_missing(write_scans):
    with pytest.raises(InputError, match="have no labels"):
        bake([write_scans(labels="none")], replace(PLAIN, labels="consistent"))


def test_progress_names_the_stages_in_order(write_scans):
    told = []
    bake([write_scans()], PLAIN, lambda stage, done, total: told.append((stage, done, total)))
    stages = list(dict.fromkeys(stage for stage, _, _ in told))
    assert stages[0] == "reading"
    assert stages[-3:] == ["segmentation", "matching", "transport"]
    for stage in stages:
        counts = [(done, total) for name, done, total in told if name == stage]
        assert counts == sorted(counts)
        assert counts[-1][0] == counts[-1][1]


def test_a_bud_has_as_many_points_as_asked(write_scans):
    clip = bake([write_scans()], replace(PLAIN, bud=3))
    births = [p for k in clip.intervals for p in k.segments if p.event == "birth"]
    assert births
    assert all(pair.start_points == 3 for pair in births)


def test_segment_colors_blend_from_scan_to_scan(write_scans):
    """Labels numbered anew: an organ's colour differs between scans and blends on the way."""
    folder = write_scans(labels="shuffled")
    clip = bake([folder], replace(PLAIN, colors="segment"))
    interval = clip.intervals[0]
    for end, scan in ((interval.start_colors, 0), (interval.end_colors, 1)):
        labels = np.loadtxt(folder / f"day{scan:02d}.txt")[:, 3]
        assert len(np.unique(end, axis=0)) == len(np.unique(labels))
    first, middle, last = (clip.at(t) for t in (1e-6, 0.5, 1 - 1e-6))
    changed = (first.colors != last.colors).any(axis=1)
    assert changed.any()
    assert (middle.colors[changed] != first.colors[changed]).any(axis=1).all()


def test_colors_can_be_left_out(write_scans):
    assert not bake([write_scans()], replace(PLAIN, colors="none")).has_colors


@pytest.mark.parametrize(
    ("field", "value"), [("decay", "rot"), ("up", "w"), ("align", "no"), ("bud", 0), ("every", 0)]
)
def test_options_that_are_none_are_refused(field, value):
    with pytest.raises(InputError, match=f"{field} is"):
        Options(**{field: value})


def test_organs_without_labels_are_listed_as_they_appear_along_the_stem(write_scans):
    clip = bake([write_scans(labels="shuffled")], replace(PLAIN, labels="independent"))
    names = [track.name for track in clip.track_table]
    assert names == ["stem", *(f"leaf {number}" for number in range(1, len(names)))]
    last = clip.at(clip.times[-1])
    lowest = [last.positions[last.tracks == track, 2].min() for track in range(1, len(names))]
    births = [track.born for track in clip.track_table[1:]]
    assert sorted(zip(births, lowest, strict=True)) == [*zip(births, lowest, strict=True)]
    used = {int(t) for interval in clip.intervals for t in np.unique(interval.tracks)}
    assert used == set(range(len(names)))
    assert all(track.parent in (None, 0) for track in clip.track_table)
