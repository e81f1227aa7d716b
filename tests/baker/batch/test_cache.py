"""A cache gives the bytes of a clean bake, and saves what has not changed."""

import os
import shutil
import threading
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import msgspec
import numpy as np
import pytest

from baker import Options
from baker.batch.cache import Cache
from baker.interpolation.interval_job import solve_intervals
from baker.pipeline import bake_with_survey
from gclip.errors import UserError
from tests.baker.conftest import write_series

PLAIN = Options(align="none", up="z", workers=1)


def bake_with(cache, scans, options=PLAIN):
    return bake_with_survey([*scans], options, solve=cache.solve_intervals)[0]


@pytest.fixture(scope="module")
def scans(tmp_path_factory) -> list[Path]:
    return sorted(write_series(tmp_path_factory.mktemp("series"), days=range(5)).iterdir())


@pytest.fixture(scope="module")
def first_bake(scans, tmp_path_factory) -> Path:
    """A folder with a cache and the clip of the bake that filled it."""
    folder = tmp_path_factory.mktemp("first")
    bake_with(Cache(folder / "cache"), scans).save(folder / "cached.gclip")
    return folder


@pytest.fixture
def kept(first_bake, tmp_path) -> list[Path]:
    """The entries of a cache in which all intervals are."""
    shutil.copytree(first_bake, tmp_path, dirs_exist_ok=True)
    return sorted((tmp_path / "cache").glob("*/*"))


@pytest.fixture
def baked(tmp_path):
    """Bake with a cache, check it against a clean bake, return what was found and solved."""

    def bake(scans, options=PLAIN, clean=True):
        cache = Cache(tmp_path / "cache")
        bake_with(cache, scans, options).save(tmp_path / "cached.gclip")
        if clean:
            bake_with_survey([*scans], options)[0].save(tmp_path / "clean.gclip")
            clean_bytes = (tmp_path / "clean.gclip").read_bytes()
            assert (tmp_path / "cached.gclip").read_bytes() == clean_bytes
        return cache.read, cache.solved

    return bake


@pytest.mark.parametrize("options", [PLAIN, replace(PLAIN, paper=True)], ids=["default", "paper"])
def test_a_second_bake_solves_nothing(scans, baked, options):
    assert baked(scans, options, clean=False) == (0, 4)
    assert baked(scans, options) == (4, 0)


def test_a_scan_more_costs_its_own_intervals(scans, baked):
    baked(scans[:4], clean=False)
    found, solved = baked(scans)
    # How fast the last organ was born shows in the scan after.
    assert solved <= 2
    assert found == 4 - solved


@pytest.mark.parametrize(
    ("change", "solved"),
    [
        # Nothing is lost, and there are labels.
        ({"decay": "fade", "workers": 2, "unit": "mm", "graph_neighbors": 7}, 0),
        ({"labels": "consistent"}, 0),
        ({"bud": 12}, 2),  # in two of them an organ is born
        ({"transport": "sinkhorn"}, 4),
        ({"even": 0.5}, 4),
        ({"paths": "straight"}, 4),
        ({"precision": "float32"}, 4),
    ],
    ids=str,
)
def test_an_option_costs_what_depends_on_it(scans, kept, baked, change, solved):
    assert baked(scans, replace(PLAIN, **change)) == (4 - solved, solved)


@pytest.mark.parametrize(
    "harm", ["cut", "flipped", "emptied", "swapped", "folder", "noise", "pipe"]
)
def test_a_damaged_entry_is_solved_again(scans, kept, baked, tmp_path, harm):
    clip = (tmp_path / "cached.gclip").read_bytes()
    first, second, *_ = kept
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


OTHER_TRACKS = "tracks that no organ has"


@pytest.mark.parametrize(
    "forgeries",
    [
        [
            {"start": 7.0},
            {"start": -7.0},
            {"tracks": ["<u2", [3], b"\0" * 6]},
            {"curve": [["<f8", [1], b"\0" * 8]] * 2},
        ],
        [
            {"curve": [["|O", [1], b"\0" * 8]] * 2},
            {"tracks": OTHER_TRACKS},
            {"groups": []},
            {"box": {"low": [1, 1, 1], "high": [0, 0, 0]}},
        ],
    ],
)
def test_forged_entries_are_solved_again(scans, kept, baked, tmp_path, forgeries):
    """Those with a digest that is right, of what the program would never write."""
    clip = (tmp_path / "cached.gclip").read_bytes()
    for path, forged in zip(kept, forgeries, strict=True):
        found = msgspec.msgpack.decode(path.read_bytes()[32:])
        if forged == {"tracks": OTHER_TRACKS}:
            dtype, shape, data = found["tracks"]
            forged = {"tracks": [dtype, shape, b"\xc8" + data[1:]]}
        payload = msgspec.msgpack.encode(found | forged)
        path.write_bytes(sha256(path.name.encode() + payload).digest() + payload)
    assert baked(scans, clean=False) == (0, 4)
    assert (tmp_path / "cached.gclip").read_bytes() == clip


def test_a_bake_that_is_stopped_goes_on_where_it_was(scans, baked, tmp_path, monkeypatch):
    def two_intervals(jobs, report_progress, workers):
        yield from solve_intervals(jobs[:2], report_progress, workers)
        raise KeyboardInterrupt

    with monkeypatch.context() as stopped:
        stopped.setattr("baker.batch.cache.solve_intervals", two_intervals)
        with pytest.raises(KeyboardInterrupt):
            bake_with(Cache(tmp_path / "cache"), scans)
    assert baked(scans) == (2, 2)


def test_two_bakes_share_a_cache_at_once(scans, tmp_path):
    clips = []

    def bake():
        clips.append(bake_with(Cache(tmp_path / "one"), scans))

    threads = [threading.Thread(target=bake) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for number, clip in enumerate(clips):
        clip.save(tmp_path / f"{number}.gclip")
    assert len({(tmp_path / f"{number}.gclip").read_bytes() for number in range(3)}) == 1
    assert len([*(tmp_path / "one").glob("*/*")]) == 4
    assert not [*(tmp_path / "one").rglob(".*")]


def test_a_cache_that_takes_nothing_does_not_stop_the_bake(scans, tmp_path):
    cache = Cache(tmp_path / "cache")
    shutil.rmtree(cache.folder)
    assert len(bake_with(cache, scans).intervals) == 4
    assert cache.summary().startswith("0 of 4 intervals; not all others could be kept: ")


def test_a_file_is_no_cache(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="file can't be written: File exists"):
        Cache(tmp_path / "file")


def test_keys_tell_contents_apart(tmp_path):
    a = np.arange(6, dtype=np.int64)
    different = [
        *(a, a.reshape(2, 3), a.astype(np.uint64), a[:5], a + 1, [a, a], [[a], a]),
        *("0", 0, 0.0, None, "", (), False, {"a": 1}, {"b": 1}, {"a": 2}, ["ab"], ["a", "b"]),
    ]
    key = Cache(tmp_path)._key
    assert len({key(value) for value in different}) == len(different)
    assert key(a) == key(np.concatenate([a, a])[:6])
    for value in (object(), np.array([object()])):
        with pytest.raises((TypeError, ValueError)):
            key(value)
