"""A part that a scan lacks leaves or is filled in; what is left of the organ does not shrink."""

from __future__ import annotations

import numpy as np
import pytest

from baker import Options, bake
from gclip.clip import Motion
from grow import plant

DAYS, LEAF = (8.0, 8.5, 9.0), 1


@pytest.fixture(scope="module")
def maize():
    return plant("maize", 3)


@pytest.fixture
def write(maize, tmp_path):
    """Scans in which the far third of a leaf is missing at the days that `lacking` names."""

    def series(lacking):
        for day in DAYS:
            cloud = maize.cloud(day, points=4000)
            points, labels = cloud.points, cloud.labels
            if day in lacking:
                base = np.array(maize.organs(day)[LEAF].base)
                away = np.linalg.norm(points - base, axis=1)
                limit = np.quantile(away[labels == LEAF], 0.65)
                kept = (labels != LEAF) | (away < limit)
                points, labels = points[kept], labels[kept]
            table = np.c_[points, labels]
            np.savetxt(tmp_path / f"day{day:04.1f}.txt", table, fmt="%.4f %.4f %.4f %d")
        return tmp_path

    return series


def leaf_extent(maize, frame, day):
    mine = frame.local[frame.tracks == LEAF]
    base = np.array(maize.organs(day)[LEAF].base)
    return np.quantile(np.linalg.norm(mine - base, axis=1), 0.98)


def baked(folder, **options):
    return bake([folder], Options(align="none", up="z", labels="consistent", **options))


def motions(interval):
    return {group.motion for group in interval.groups}


def notes(interval):
    return " ".join(note for pair in interval.segments for note in pair.notes)


def test_whole_leaves_lack_nothing(write):
    clip = baked(write(lacking=()))
    assert [motions(interval) for interval in clip.intervals] == [{Motion.MOVE}] * 2


@pytest.mark.parametrize("decay", [Motion.FALL, Motion.REMOVE])
def test_what_never_comes_back_was_cut_and_leaves_as_lost_organs_do(write, decay):
    clip = baked(write(lacking=DAYS[1:]), decay=decay)
    assert motions(clip.intervals[0]) == {Motion.MOVE, decay}
    assert motions(clip.intervals[1]) == {Motion.MOVE}
    assert f"cut off by day{DAYS[1]:04.1f}" in notes(clip.intervals[0])


def test_what_is_hidden_fades_and_the_rest_stays_where_it_is(write, maize):
    folder = write(lacking=DAYS[1:2])
    clip = baked(folder)
    assert motions(clip.intervals[0]) == {Motion.MOVE, Motion.FADE}
    assert "hidden in" in notes(clip.intervals[0])
    frame = clip.at(DAYS[1] - 0.1)
    assert leaf_extent(maize, frame, DAYS[1]) > 0.95 * leaf_extent(maize, clip.at(8.0), 8.0)


def test_what_is_hidden_can_be_filled_in(write, maize):
    folder = write(lacking=DAYS[1:2])
    filled, shrunk = baked(folder, missing="fill"), baked(folder, missing="shrink")
    whole = leaf_extent(maize, filled.at(8.0), 8.0)
    for day in np.linspace(DAYS[0], DAYS[-1], 9):
        assert leaf_extent(maize, filled.at(day), day) > 0.95 * whole
    assert leaf_extent(maize, shrunk.at(DAYS[1]), DAYS[1]) < 0.8 * whole
    assert motions(filled.intervals[0]) == {Motion.MOVE}


def test_a_plant_that_shrinks_as_a_whole_loses_no_parts(write, maize, tmp_path):
    folder = tmp_path / "backwards"
    folder.mkdir()
    for number, day in enumerate((12.0, 8.0, 4.0)):
        cloud = maize.cloud(day, points=4000)
        np.savetxt(folder / f"day{number}.txt", np.c_[cloud.points, cloud.labels], fmt="%.4f")
    clip = baked(folder)
    assert not any("cut off" in notes(interval) for interval in clip.intervals)
