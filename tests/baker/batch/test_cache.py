"""A cache gives the bytes of a clean bake, and saves what has not changed."""

import os
import shutil
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from baker import InputError, Options
from baker.batch.cache import IntervalCache
from baker.batch.cache.alignments import aligned
from baker.batch.cache.digest import digest
from baker.batch.cache.intervals import packed_alike
from baker.pipeline import bake_recorded
from gclip import Motion
from gclip.pack import Movers, pack_interval

PLAIN = Options(align="none", up="z", workers=1)


@pytest.fixture
def baked(tmp_path):
    """Bake with a cache, check it against a clean bake, tell what was found and what was solved."""

    def bake(scans, options=PLAIN, folder="cache", clean=True):
        cache = IntervalCache(tmp_path / folder)
        clip = bake_recorded([*scans], options, cache=cache)[0]
        clip.save(tmp_path / "cached.gclip")
        if clean:
            bake_recorded([*scans], options)[0].save(tmp_path / "clean.gclip")
            clean_bytes = (tmp_path / "clean.gclip").read_bytes()
            assert (tmp_path / "cached.gclip").read_bytes() == clean_bytes
        return cache.found, cache.solved

    return bake


@pytest.fixture
def scans(write_scans) -> list[Path]:
    return sorted(write_scans(days=(0, 1, 2, 3, 4)).iterdir())


@pytest.mark.parametrize(
    "options",
    [PLAIN, replace(PLAIN, paper=True)],
    ids=["default", "paper"],
)
def test_a_second_bake_solves_nothing(scans, baked, options):
    assert baked(scans, options, clean=False) == (0, 4)
    assert baked(scans, options) == (4, 0)


def test_a_scan_more_costs_its_own_intervals(scans, baked):
    baked(scans[:4], clean=False)
    found, solved = baked(scans)
    # How fast the last organ was born shows in the scan after.
    assert solved <= 2
    assert found == 4 - solved


def test_a_scan_less_at_the_front_costs_little(scans, baked):
    baked(scans, clean=False)
    found, solved = baked(scans[1:])
    assert solved <= 1  # how organs grew before may tell how they grow on
    assert found == 3 - solved


def test_a_scan_less_between_costs_the_interval_across_the_gap(scans, baked):
    paper = replace(PLAIN, paper=True)  # births look at no later scan there
    baked(scans, paper, clean=False)
    assert baked([scans[0], *scans[2:]], paper) == (2, 1)


@pytest.mark.parametrize(
    ("change", "solved"),
    [
        ({"decay": "fade"}, 0),  # nothing is lost
        ({"workers": 2}, 0),
        ({"colors": "segment"}, 0),
        ({"colors": "none"}, 0),
        ({"unit": "mm"}, 0),
        ({"neighbors": 7}, 0),  # those of Sinkhorn's support
        ({"transport": "exact"}, 0),
        ({"graph_neighbors": 7}, 0),  # there are labels
        ({"bifurcation": 3}, 0),
        ({"labels": "consistent"}, 0),
        ({"bud": 12}, 2),  # in two of them an organ is born
        ({"transport": "sinkhorn"}, 4),
        ({"even": 0.5}, 4),
        ({"paths": "straight"}, 4),
        ({"precision": "float32"}, 4),
    ],
    ids=lambda value: str(value),
)
def test_an_option_costs_what_depends_on_it(scans, baked, change, solved):
    baked(scans, clean=False)
    assert baked(scans, replace(PLAIN, **change)) == (4 - solved, solved)


@pytest.mark.parametrize("reverse", [True, False])
def test_colors_cost_nothing(write_scans, baked, reverse):
    """Nor do scans of other colours: the movers are the same."""
    scans = sorted(write_scans(days=(0, 1, 2), reverse=reverse).iterdir())
    for k, scan in enumerate(scans):
        rows = np.loadtxt(scan)
        colors = np.random.default_rng(k).integers(0, 256, (len(rows), 3))
        np.savetxt(scan, np.column_stack([rows[:, :3], colors, rows[:, 3]]), fmt="%.4f")
    options = replace(PLAIN, even=1.0)
    assert baked(scans, options) == (0, 2)
    for colors in ("segment", "none", "scan"):
        assert baked(scans, replace(options, colors=colors)) == (2, 0)
    for scan in scans:
        rows = np.loadtxt(scan)
        rows[:, 3:6] = 255 - rows[:, 3:6]
        np.savetxt(scan, rows, fmt="%.4f")
    assert baked(scans, options) == (2, 0)


def test_other_times_and_names_cost_nothing(scans, baked, tmp_path):
    baked(scans, replace(PLAIN, paper=True), clean=False)
    later = tmp_path / "later"
    later.mkdir()
    for day, scan in enumerate(scans):
        shutil.copy(scan, later / f"day{10 + 3 * day}.txt")
    assert baked(sorted(later.iterdir()), replace(PLAIN, paper=True)) == (4, 0)


@pytest.mark.parametrize(
    "harm", ["cut", "flipped", "emptied", "swapped", "folder", "noise", "pipe"]
)
def test_a_damaged_entry_is_solved_again(scans, baked, tmp_path, harm):
    baked(scans, clean=False)
    clip = (tmp_path / "cached.gclip").read_bytes()
    first, second = sorted((tmp_path / "cache").rglob("*.gclip"))[:2]
    whole = first.read_bytes()
    if harm == "cut":
        first.write_bytes(whole[: len(whole) // 2])
    elif harm == "flipped":
        first.write_bytes(whole[:-9] + bytes([whole[-9] ^ 4]) + whole[-8:])
    elif harm == "emptied":
        first.write_bytes(b"")
    elif harm == "swapped":
        shutil.copy(second, first)
    elif harm == "noise":
        first.write_bytes(np.random.default_rng(0).bytes(len(whole)))
    elif harm == "pipe":
        first.unlink()
        os.mkfifo(first)
    else:
        first.unlink()
        first.mkdir()
    assert baked(scans, clean=False) == (3, 1)
    assert (tmp_path / "cached.gclip").read_bytes() == clip
    if harm != "folder":
        assert first.read_bytes() == whole


def test_a_bake_that_is_stopped_goes_on_where_it_was(scans, baked, tmp_path, monkeypatch):
    put = IntervalCache.put

    def put_two(self, key, interval):
        put(self, key, interval)
        if self.solved == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(IntervalCache, "put", put_two)
    with pytest.raises(KeyboardInterrupt):
        baked(scans, clean=False)
    monkeypatch.setattr(IntervalCache, "put", put)
    assert baked(scans) == (2, 2)


def test_two_bakes_share_a_cache_at_once(scans, tmp_path):
    clips = []

    def bake():
        clips.append(bake_recorded([*scans], PLAIN, cache=IntervalCache(tmp_path / "one"))[0])

    threads = [threading.Thread(target=bake) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for number, clip in enumerate(clips):
        clip.save(tmp_path / f"{number}.gclip")
    assert len({(tmp_path / f"{number}.gclip").read_bytes() for number in range(3)}) == 1
    assert len([*(tmp_path / "one").rglob("*.gclip")]) == 4
    assert not [*(tmp_path / "one").rglob(".*")]


def test_a_cache_that_takes_nothing_does_not_stop_the_bake(scans, tmp_path, monkeypatch):
    cache = IntervalCache(tmp_path / "cache")
    shutil.rmtree(cache.folder)
    clip = bake_recorded([*scans], PLAIN, cache=cache)[0]
    assert len(clip.intervals) == 4
    assert cache.told().startswith("0 of 4 intervals; not all others could be kept: ")


def test_the_alignment_is_kept_too(scans, baked, tmp_path, monkeypatch):
    turned = replace(PLAIN, align="auto")
    baked(scans[:3], turned, clean=False)
    monkeypatch.setattr("baker.batch.cache.alignments.align", None)
    assert baked(scans[:3], replace(turned, decay="fade"), clean=False) == (2, 0)


@pytest.mark.parametrize("harm", ["cut", "changed", "other", "deep", "emptied", "pipe"])
def test_a_damaged_alignment_is_found_again(tmp_path, harm):
    cache = IntervalCache(tmp_path)
    clouds = [np.random.default_rng(k).random((60, 3)).astype(np.float32) for k in range(2)]
    first = aligned(cache, clouds, "icp", "z", None)
    (entry,) = tmp_path.rglob("*.json")
    whole = entry.read_text()
    harmed = {"cut": whole[:-40], "changed": whole.replace("1.0", "2.0"), "other": "[null, 3]"}
    if harm == "pipe":
        entry.unlink()
        os.mkfifo(entry)
    else:
        entry.write_text({**harmed, "deep": "[" * 100_000, "emptied": ""}[harm])
    again = aligned(cache, clouds, "icp", "z", None)
    assert entry.read_text() == whole
    assert digest(first) == digest(again) == digest(aligned(cache, clouds, "icp", "z", None))


def test_a_file_is_no_cache(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="file can't be a cache"):
        IntervalCache(tmp_path / "file")


def test_packing_is_asked_for_with_the_spacing_of_the_series():
    points = np.random.default_rng(0).random((50, 3))
    movers = Movers(Motion.MOVE, (points, points), np.zeros(50, int))
    for spacing in (1.0, 1e-5):
        for precision in ("auto", "float32"):
            packed = pack_interval(0, 1, [movers], spacing=spacing, precision=precision)
            for other in (1.0, 1e-5):
                again = pack_interval(0, 1, [movers], spacing=other, precision=precision)
                same = (packed.box is None) == (again.box is None)
                assert packed_alike(packed, other, precision) == same


def test_digests_tell_contents_apart():
    a = np.arange(6, dtype=np.int64)
    different = [
        a,
        a.reshape(2, 3),
        a.astype(np.uint64),
        a[:5],
        a + 1,
        [a, a],
        [[a], a],
        "0",
        0,
        0.0,
    ]
    different += [
        None,
        "",
        (),
        False,
        {"a": 1},
        {"b": 1},
        {"a": 2},
        ["ab"],
        ["a", "b"],
        PLAIN.align,
    ]
    assert len({digest(value) for value in different}) == len(different)
    assert digest({"a": 1, "b": 2}) == digest({"b": 2, "a": 1})
    assert digest(a) == digest(np.concatenate([a, a])[:6])
    with pytest.raises(TypeError):
        digest(object())
    with pytest.raises(TypeError):
        digest(np.array([object()]))
