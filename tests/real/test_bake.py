"""Real scans baked whole: scans are kept, surfaces move as sheets, hard input comes out right."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker import Options, bake
from gclip import Clip


def farthest_apart(a: np.ndarray, b: np.ndarray) -> float:
    return max(cKDTree(a).query(b)[0].max(), cKDTree(b).query(a)[0].max())


def size_of(clip: Clip) -> float:
    low, high = clip.bounds
    return float((high - low).max())


def aligned(clip: Clip, folder, scan: int) -> np.ndarray:
    points = np.loadtxt(folder / clip.scans[scan].name)[:, :3]
    transform = np.array(clip.provenance["transforms"][scan])
    return points @ transform[:3, :3].T + transform[:3, 3]


@pytest.mark.parametrize(
    ("series", "organs", "births"),
    [
        ("tobacco_heat_plant3", 8, 3),
        ("unaligned/sorghum_control_plant1", 5, 2),
    ],
)
def test_scans_are_kept_and_organs_counted(shared_data, series, organs, births):
    folder = shared_data / series
    clip = bake([folder])
    for scan, time in enumerate(clip.times):
        gap = farthest_apart(clip.at(time).positions, aligned(clip, folder, scan))
        assert gap < 2e-5 * size_of(clip)
    assert len(clip.track_table) == organs
    assert sum(p.event == "birth" for k in clip.intervals for p in k.segments) == births
    assert all(p.marginal_error < 1e-9 for k in clip.intervals for p in k.segments)


def test_the_sorghum_grows_along_y(shared_data):
    files = sorted((shared_data / "unaligned/sorghum_control_plant1").glob("*.txt"))[:2]
    assert bake(files, Options(voxel=2.0)).up == "y"


def test_a_surface_moves_as_one_sheet(shared_data):
    """Neighbours that swap places, as the fidelity judge counts them: at most one in a hundred."""
    files = sorted((shared_data / "tobacco_heat_plant3").glob("*.txt"))[:2]
    clip = bake(files, Options(align="none"))
    start, end = (clip.at(t).positions.astype(float) for t in (1e-6, clip.times[1] - 1e-6))
    _, first = np.unique(np.round(start, 6), axis=0, return_index=True)
    start, end = start[first], end[first]
    neighbors = cKDTree(start).query(start, 9)[1][:, 1:]
    before, after = start[neighbors] - start[:, None], end[neighbors] - end[:, None]
    assert np.mean((before * after).sum(axis=2) < 0) <= 0.01


def test_in_between_states_are_nearer_than_the_scans_around_them(shared_data):
    folder = shared_data / "tomato1_control2_plant1"
    kept = [folder / f"day{day:02d}.txt" for day in (6, 10)]
    clip = bake(kept, Options(align="none"))
    real = np.loadtxt(folder / "day08.txt")[:, :3]

    def apart(points: np.ndarray) -> float:
        return cKDTree(points).query(real)[0].mean() + cKDTree(real).query(points)[0].mean()

    rebuilt = apart(clip.at(8.0).positions)
    assert rebuilt < 0.5 * min(apart(np.loadtxt(path)[:, :3]) for path in kept)


def test_unlabelled_leaves_are_found(shared_data):
    files = sorted((shared_data / "tomato2_control_plant3").glob("*.txt"))[2:4]
    clip = bake(files, Options(align="none", labels="ignore"))
    assert 3 <= len(clip.track_table) <= 12
    truth = np.loadtxt(files[0])
    frame = clip.at(clip.times[0] + 1e-6)
    track = frame.tracks[cKDTree(frame.positions).query(truth[:, :3])[1]]
    overlap = []
    for organ in np.unique(truth[:, 3]):
        mine = truth[:, 3] == organ
        overlap.append(
            max((mine & (track == t)).sum() / (mine | (track == t)).sum() for t in set(track))
        )
    assert np.mean(overlap) > 0.5
