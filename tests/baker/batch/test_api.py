"""`baker.bake` from Python: what is in memory is baked as its file would be."""

from __future__ import annotations

from datetime import date
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg  # noqa: F401  # loads SciPy's own library of linear algebra
from threadpoolctl import threadpool_info, threadpool_limits

from baker import InputError, Options, bake
from gclip import Clip
from tests.baker.batch.conftest import Greenhouse


@pytest.fixture
def folder(greenhouse: Greenhouse) -> Path:
    return greenhouse(["plant"]) / "plant"


@pytest.fixture
def arrays(folder: Path) -> list[np.ndarray]:
    return [np.loadtxt(path) for path in sorted(folder.glob("*.txt"))]


def contents(clip: Clip) -> list[bytes]:
    return [np.asarray(b).tobytes() for i in clip.intervals for b in i.buffers().values()]


CHOICES = {"align": "none", "up": "z", "paths": "straight", "workers": 1}


def test_arrays_make_the_clip_that_their_files_make(folder: Path, arrays: list[np.ndarray]) -> None:
    options = Options(**CHOICES, labels="consistent")
    from_files = bake(folder, options)
    points, labels = [a[:, :3] for a in arrays], [a[:, -1].astype(int) for a in arrays]
    times = from_files.times
    assert contents(bake(points, options, times=times, labels=labels)) == contents(from_files)
    files = sorted(folder.glob("*.txt"))
    mixed = bake([files[0], points[1]], options, times=times, labels=[None, labels[1]])
    assert contents(mixed) == contents(from_files)


def test_a_clip_does_not_depend_on_the_threads_of_the_linear_algebra() -> None:
    """The cost of a plan of so many points is a sum that threads would share."""
    rng = np.random.default_rng(0)
    scans, clips, numbers = [], [], list[int]()
    for length, points in ((40.0, 12_000), (43.0, 14_000)):
        along, across = rng.random((2, points))
        width = 8.0 * (across - 0.5) * (1.0 - along)
        scans.append(np.c_[length * along, width, 3.0 * np.sin(2.0 * along)])

    def threads_of_blas() -> set[int]:
        return {lib["num_threads"] for lib in threadpool_info() if lib["user_api"] == "blas"}

    def record(*_: object) -> None:
        numbers.extend(threads_of_blas())

    for threads in (3, 4):
        with threadpool_limits(threads, user_api="blas"):
            clips.append(bake(scans, progress=record, **(CHOICES | {"transport": "whole"})))
            assert threads_of_blas() <= {threads}  # as before the bake; none are known on macOS
    assert set(numbers) <= {1}
    assert clips[0].intervals[0].segments == clips[1].intervals[0].segments
    assert contents(clips[0]) == contents(clips[1])


def test_open3d_clouds_keep_their_labels_and_colors(arrays: list[np.ndarray]) -> None:
    import open3d

    colors = [np.tile(np.uint8([10, 200, 30]), (len(a), 1)) for a in arrays]
    legacy = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(arrays[0][:, :3]))
    legacy.colors = open3d.utility.Vector3dVector(colors[0] / 255.0)
    with pytest.raises(InputError, match=r"scans\[0\]' is only one scan"):
        bake(legacy)
    tensor = open3d.t.geometry.PointCloud(arrays[1][:, :3])
    tensor.point["colors"] = open3d.core.Tensor(colors[1])
    tensor.point["label"] = open3d.core.Tensor(arrays[1][:, -1:].astype(np.int32))
    labels = [arrays[0][:, -1].astype(int), None]
    options = Options(**CHOICES, labels="consistent")
    clip = bake([legacy, tensor], options, times=[0, 2], labels=labels)
    assert len(clip.track_table) == len(np.unique(np.r_[arrays[0][:, -1], arrays[1][:, -1]]))
    assert (clip.intervals[0].end_colors[:, :3] == [10, 200, 30]).all()


@pytest.mark.parametrize("times", [["2024-05-01", "2024-05-04"], [date(2024, 5, 1), "04.05.2024"]])
def test_dates_are_read_as_people_write_them(arrays: list[np.ndarray], times: list) -> None:
    if isinstance(times[0], date):
        times = [times[0], date(2024, 5, 4)]
    clip = bake(arrays, times=times, **CHOICES)
    assert clip.times == [0.0, 3.0]
    assert [scan.date for scan in clip.scans] == ["2024-05-01", "2024-05-04"]


def test_without_times_the_order_counts(arrays: list[np.ndarray]) -> None:
    assert bake(arrays, **CHOICES).time_unit == "scans"


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"times": [1]}, "times holds 1 times for 2 scans"),
        ({"times": [1, None]}, "times: 'None' is no time; a number of days"),
        ({"times": [1, "2024-05-01"]}, "times mixes dates and numbers of days"),
        ({"times": [3, 3]}, "have the same time"),
        ({"labels": [None]}, "labels holds 1 arrays for 2 scans"),
        ({"labels": [np.zeros(3, int), None]}, r"^'scans\[0\]' has 180 points, but 3 values"),
        ({"align": "maybe"}, "align is maybe; one of auto, turn, icp, none is needed"),
    ],
)
def test_what_can_t_be_baked_is_said_in_a_sentence(
    arrays: list[np.ndarray], change: dict, sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        bake([a[:, :3] for a in arrays], **{**CHOICES, **change})


def test_scans_that_are_no_points_are_named(arrays: list[np.ndarray], folder: Path) -> None:
    with pytest.raises(InputError, match=r"scans\[1\] is an array of shape \(180, 2\)"):
        bake([arrays[0], arrays[1][:, :2]])
    file = sorted(folder.glob("*.txt"))[0]
    with pytest.raises(InputError, match="labels are for scans in memory"):
        bake([file, arrays[1]], labels=[np.zeros(180, int), None])
