"""`grow komatsuna`: images with a camera's faults, whose truth says how well they are repaired."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from baker.errors import InputError
from baker.scans.read import read_series
from baker.scans.rgbd.camera import Camera, read_camera
from baker.scans.rgbd.depth_repair import repair
from baker.scans.rgbd.images import read_depth, read_labels
from baker.scans.rgbd.series import Frame, find_frames
from grow.cli import main
from grow.faults import Faults
from grow.images import ImagePlan, rosette, write_images
from grow.picture import View, take_picture


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Seven days, one image each."""
    folder = tmp_path_factory.mktemp("komatsuna") / "images"
    write_images(ImagePlan(days=7, per_day=1), folder)
    return folder


def near_border(labels: NDArray[np.int64], width: int) -> NDArray[np.bool_]:
    """Labelled pixels with one of another label (or none) within `width` pixels."""
    from scipy.ndimage import maximum_filter, minimum_filter

    size = 2 * width + 1
    return (labels > 0) & (maximum_filter(labels, size) != minimum_filter(labels, size))


def border_errors(folder: Path, camera: Camera, frame: Frame) -> tuple[NDArray, NDArray]:
    """mm off the true depth in the 3 outermost pixels of every organ, as measured and repaired."""
    measured, labels = (
        read_depth(frame.depth, camera.depth_unit),
        read_labels(frame.label or Path()),
    )
    truth = read_depth(folder / "truth" / frame.depth.name, camera.depth_unit)
    true_labels = read_labels(folder / "truth" / frame.depth.name.replace("depth", "label"))
    repaired, _ = repair(measured, labels)
    border = near_border(labels, 3) & (labels == true_labels)
    before, after = border & (measured > 0), border & (repaired > 0)
    assert after.sum() > before.sum()
    return np.abs(measured - truth)[before], np.abs(repaired - truth)[after]


def test_the_same_command_writes_the_same_bytes(tmp_path: Path) -> None:
    options = ["--days", "1", "--per-day", "2", "--size", "120x90", "--seed", "3", "-q"]
    for name in ("one", "two"):
        assert main(["komatsuna", str(tmp_path / name), *options]) == 0
    one = contents(tmp_path / "one")
    assert one == contents(tmp_path / "two")
    assert sorted(one) == [
        "camera.toml",
        *(f"{what}_00_000_{k:02}.png" for what in ("depth", "label", "rgb") for k in (0, 1)),
        *(f"truth/{what}_00_000_{k:02}.png" for what in ("depth", "label") for k in (0, 1)),
    ]
    assert Image.open(tmp_path / "one" / "rgb_00_000_01.png").size == (120, 90)


def test_leaves_are_born_grow_and_hide_one_another(folder: Path) -> None:
    labels = [read_labels(path) for path in sorted((folder / "truth").glob("label_*.png"))]
    present = [set(np.unique(image).tolist()) - {0} for image in labels]
    assert len(present[-1]) >= len(present[0]) + 3
    assert all(before <= after for before, after in pairwise(present))
    areas = [int((image > 0).sum()) for image in labels]
    assert areas == sorted(areas)

    # Seen alone, without the leaves above it, a leaf would show more of itself.
    last = sorted((folder / "truth").glob("depth_*.png"))[-1]
    depth = np.asarray(Image.open(last)).astype(float) * 0.125
    jump = np.abs(np.diff(depth, axis=1)) > 5
    between_leaves = (labels[-1][:, 1:] != labels[-1][:, :-1]) & (labels[-1][:, 1:] > 0)
    assert (jump & between_leaves & (labels[-1][:, :-1] > 0)).sum() > 50


def test_the_picture_shows_the_plant_where_it_is() -> None:
    plant, view = rosette(0), View.over((480, 360))
    picture = take_picture(plant, 6.0, view, np.random.default_rng(0))
    cloud = plant.cloud(6.0, 20000, noise=0.0)
    depth = view.distance - cloud.points[:, 2]
    u = np.rint(view.cx + view.focal * cloud.points[:, 0] / depth).astype(int)
    v = np.rint(view.cy - view.focal * cloud.points[:, 1] / depth).astype(int)
    # What is no edge is seen, or hidden by something nearer.
    steep = np.ptp(
        [np.roll(picture.depth, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0
    )
    flat = steep[v, u] < 3
    assert flat.mean() > 0.7
    assert (depth[flat] > picture.depth[v, u][flat] - 1.5).all()
    visible = flat & (np.abs(depth - picture.depth[v, u]) < 1.5)
    assert visible.mean() > 0.5
    assert (picture.label[v, u] == cloud.labels)[visible].mean() > 0.99


def test_the_repair_brings_border_depth_near_the_truth(folder: Path) -> None:
    camera = read_camera(folder / "camera.toml")
    frames = find_frames(folder, camera.images)[::3]
    pairs = [border_errors(folder, camera, frame) for frame in frames]
    before, after = (np.concatenate(errors) for errors in zip(*pairs, strict=True))
    print(
        f"border depth error, mm: mean {before.mean():.2f} -> {after.mean():.2f}, "
        f"95 % {np.percentile(before, 95):.1f} -> {np.percentile(after, 95):.1f}"
    )
    assert before.mean() > 4.0
    assert after.mean() < 1.0
    assert np.percentile(before, 95) > 20.0
    assert np.percentile(after, 95) < 3.0


def test_misplaced_labels_are_repaired_too(tmp_path: Path) -> None:
    folder = tmp_path / "images"
    write_images(ImagePlan(days=8, per_day=1, faults=Faults(labels=1.0)), folder)
    camera = read_camera(folder / "camera.toml")
    frames = find_frames(folder, camera.images)[6:]
    pairs = [border_errors(folder, camera, frame) for frame in frames]
    before, after = (np.concatenate(errors) for errors in zip(*pairs, strict=True))
    assert after.mean() < 0.3 * before.mean()


def test_the_series_reads_as_scans(folder: Path) -> None:
    from scipy.spatial import cKDTree

    series = read_series([folder])
    assert [scan.time for scan in series.scans] == list(range(7))
    assert (series.fixed, series.root) == (True, "virtual")
    plant = rosette(0)
    for scan in series.scans[4::2]:
        true = plant.cloud(scan.time, 60000, noise=0.0)
        off, nearest = cKDTree(true.points).query(scan.points + scan.origin)
        assert np.median(off) < 0.8
        assert np.percentile(off, 95) < 2.0
        assert scan.labels is not None
        assert (scan.labels == true.labels[nearest])[off < 1].mean() > 0.98


def test_unlabelled(tmp_path: Path) -> None:
    command = ["komatsuna", str(tmp_path / "k"), "--days", "2", "--per-day", "1"]
    assert main([*command, "--size", "100x80", "--unlabelled", "-q"]) == 0
    assert not list((tmp_path / "k").glob("label_*"))
    assert (tmp_path / "k" / "truth" / "label_00_000_00.png").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--scans", "4"], "--scans means nothing for komatsuna"),
        (["--pose"], "--pose means nothing for komatsuna"),
        (["--format", "las"], "--format means nothing for komatsuna"),
        (["--days", "1.5"], "komatsuna takes whole days"),
        (["--days", "inf"], "komatsuna takes whole days"),
        (["--days", "99"], "99 days of images: this plant grows for 1 to 12 days"),
        (["--days", "1", "--per-day", "1"], "one image is no series"),
        (["--per-day", "0"], "0 images a day"),
        (["--size", "480"], "--size 480: width and height are needed"),
        (["--size", "4x4"], "each side must have 32"),
        (["--noise", "-1"], "the noise is -1 mm"),
        (["--label-shift", "-1"], "labels misplaced by -1 pixels"),
        (["--seed", "-1"], "the seed is -1"),
    ],
)
def test_what_can_not_be_grown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], said: str
) -> None:
    assert main(["komatsuna", str(tmp_path / "k"), *options]) == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_images_mean_nothing_for_scanned_plants(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["maize", str(tmp_path / "m"), "--size", "480x360"]) == 2
    assert "--size means nothing for maize" in capsys.readouterr().err


def test_earlier_images_are_kept_unless_forced(tmp_path: Path) -> None:
    plan = ImagePlan(days=2, per_day=1, size=(64, 48))
    write_images(plan, tmp_path / "k")
    with pytest.raises(InputError, match=r"camera\.toml exists; --force overwrites it"):
        write_images(plan, tmp_path / "k")
    write_images(ImagePlan(days=1, per_day=3, size=(64, 48)), tmp_path / "k", force=True)
    assert len(list((tmp_path / "k").glob("rgb_*"))) == 3
