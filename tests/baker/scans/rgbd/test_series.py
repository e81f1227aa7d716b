"""A folder of images, read by `read_series` like any other series."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from baker.errors import InputError
from baker.options import Options
from baker.scans.read import read_series

CAMERA = "fx = 100.0\nfy = 120.0\ncx = 20.0\ncy = 14.5\n"
SIZE = (30, 40)
GROUND = 400

FolderMaker = Callable[..., Path]


def leaf(frame: int) -> NDArray[np.bool_]:
    inside = np.zeros(SIZE, bool)
    inside[5:20, 4 : 20 + 2 * frame] = True
    return inside


@pytest.fixture
def make_images(tmp_path: Path) -> FolderMaker:
    """A folder of frames: a square leaf (label 3), 40 mm over the ground, and what differs.

    camera: text of camera.toml. names: of the frames. extra: files, name to image.
    without: patterns of what to delete in the end.
    """

    def make(
        camera: str | None = CAMERA,
        names: tuple[str, ...] = ("000_00", "000_03", "001_00"),
        extra: dict[str, NDArray] | None = None,
        without: str | None = None,
    ) -> Path:
        folder = tmp_path / "images"
        folder.mkdir()
        if camera is not None:
            (folder / "camera.toml").write_text(camera)
        for k, name in enumerate(names):
            inside = leaf(k)
            color = np.where(inside[..., None], [10, 200, 30 + k], [90, 70, 50]).astype(np.uint8)
            depth = np.where(inside, GROUND - 40, GROUND).astype(np.uint16)
            images = {
                "rgb": color,
                "depth": depth,
                "label": np.where(inside, 3, 0).astype(np.uint8),
            }
            for what, image in images.items():
                Image.fromarray(image).save(folder / f"{what}_{name}.png")
        for name, image in (extra or {}).items():
            Image.fromarray(image).save(folder / name)
        for path in folder.glob(without or "nothing"):
            path.unlink()
        return folder

    return make


def test_points_lie_where_the_camera_saw_them(make_images: FolderMaker) -> None:
    series = read_series([make_images()])
    assert [scan.time for scan in series.scans] == [0.0, 0.5, 1.0]
    assert series.unit == "days"
    assert series.fixed
    assert series.root == "virtual"
    for k, scan in enumerate(series.scans):
        v, u = np.nonzero(leaf(k))
        expected = np.stack([(u - 20) / 100 * 360, -(v - 14.5) / 120 * 360, np.full(len(u), 40)])
        np.testing.assert_allclose(scan.points, expected.T, atol=1e-4)
        assert scan.labels is not None
        assert set(scan.labels.tolist()) == {3}
        assert scan.colors is not None
        np.testing.assert_array_equal(np.unique(scan.colors, axis=0), [[10, 200, 30 + k]])


def test_units_crop_and_ground(make_images: FolderMaker) -> None:
    folder = make_images()
    usual = read_series([folder]).scans[0]
    inside = leaf(0)
    wide = np.full((SIZE[0] + 9, SIZE[1] + 7), 4 * GROUND, np.uint16)
    wide[4 : 4 + SIZE[0], 5 : 5 + SIZE[1]] = np.where(inside, 4 * (GROUND - 40), 4 * GROUND)
    for path in folder.glob("depth_*.png"):
        Image.fromarray(wide).save(path)
    (folder / "camera.toml").write_text(
        CAMERA.replace("cx = 20.0", "cx = 25.0").replace("14.5", "18.5")
        + "depth_unit = 0.25\ncrop = [5, 4]\nground = 410\n"
    )
    scan = read_series([folder]).scans[0]
    np.testing.assert_allclose(scan.points, usual.points + np.float32([0, 0, 10]), atol=1e-4)


def test_labels_in_colours_are_numbered_by_them(make_images: FolderMaker) -> None:
    folder = make_images(camera=CAMERA + "background = 0xffffff\n")
    for k, path in enumerate(sorted(folder.glob("label_*.png"))):
        painted = np.where(leaf(k)[..., None], [255, 0, 1], [255, 255, 255]).astype(np.uint8)
        painted[5:20, 4:9] = [0, 0, 0]
        Image.fromarray(painted).save(path)
    for scan in read_series([folder]).scans:
        assert scan.labels is not None
        assert set(scan.labels.tolist()) == {0xFF0001, 0}


def test_a_palette_image_is_numbered_by_its_indices(make_images: FolderMaker) -> None:
    folder = make_images()
    for path in folder.glob("label_*.png"):
        image = Image.open(path)
        image.putpalette([0, 0, 0, 9, 9, 9, 8, 8, 8, 200, 0, 0])
        image.save(path)
    scan = read_series([folder]).scans[0]
    assert Image.open(next(folder.glob("label_*.png"))).mode == "P"
    assert scan.labels is not None
    assert set(scan.labels.tolist()) == {3}


def test_every_filled_pixel_is_counted(make_images: FolderMaker) -> None:
    folder = make_images()
    painted = np.zeros(SIZE, np.uint8)
    painted[8:10, 8:12] = 255
    Image.fromarray(painted).save(folder / "mask_000_00.png")
    depth = np.asarray(Image.open(folder / "depth_000_00.png")).copy()
    depth[12, 6:9] = 0
    depth[5, 4:10] = GROUND  # on the border
    Image.fromarray(depth).save(folder / "depth_000_00.png")

    scan = read_series([folder]).scans[0]
    total = int(leaf(0).sum())
    beside_painted, beside_missing, beside_jumps = 6 * 4 - 8, 5 * 3 - 3, 8
    beside = beside_painted + beside_missing + beside_jumps
    assert scan.notes[0] == (
        f"depth unknown at {8 + 3 + 6 + beside} of {total} labelled pixels; {8 + 3 + 6 + beside} "
        "filled by convolution, 0 left out: none valid nearby."
    )
    np.testing.assert_allclose(scan.points[:, 2], 40, atol=1e-3)


def test_a_label_without_depth_is_left_out_and_said(make_images: FolderMaker) -> None:
    folder = make_images()
    label = np.asarray(Image.open(folder / "label_000_00.png")).copy()
    label[25:28, 30:36] = 7
    Image.fromarray(label).save(folder / "label_000_00.png")
    depth = np.asarray(Image.open(folder / "depth_000_00.png")).copy()
    depth[25:28, 30:36] = 0
    Image.fromarray(depth).save(folder / "depth_000_00.png")
    scan = read_series([folder]).scans[0]
    assert scan.labels is not None
    assert set(scan.labels.tolist()) == {3}
    assert "18 left out: none valid nearby" in scan.notes[0]


def test_without_label_images_all_depth_becomes_points(make_images: FolderMaker) -> None:
    painted = np.where(leaf(0), 9, 0).astype(np.uint8)
    series = read_series([make_images(without="label_*.png", extra={"mask_000_00.png": painted})])
    whole = SIZE[0] * SIZE[1]
    assert [len(scan) for scan in series.scans] == [whole - leaf(0).sum(), whole, whole]
    assert series.scans[0].labels is None
    assert series.root is None


def test_images_in_folders_of_their_own(make_images: FolderMaker) -> None:
    """As the Komatsuna data has them: depth for all plants, colour and labels for each."""
    patterns = (
        '[images]\ncolor = "plants/rgb_00_*.png"\ndepth = "depths/depth_*.png"\n'
        'label = "labels/label_00_*.png"\n'
    )
    folder = make_images(camera=CAMERA + patterns)
    for what, parent, plant in (
        ("rgb", "plants", "00_"),
        ("depth", "depths", ""),
        ("label", "labels", "00_"),
    ):
        (folder / parent).mkdir()
        for path in folder.glob(f"{what}_*.png"):
            path.rename(folder / parent / path.name.replace(f"{what}_", f"{what}_{plant}"))
    series = read_series([folder])
    assert [scan.name for scan in series.scans] == [
        f"rgb_00_{name}.png" for name in ("000_00", "000_03", "001_00")
    ]
    assert [len(scan) for scan in series.scans] == [leaf(k).sum() for k in range(3)]


def test_labels_can_be_ignored_but_still_cut_out_the_plant(make_images: FolderMaker) -> None:
    series = read_series([make_images()], Options(labels="ignore"))
    assert len(series.scans[0]) == leaf(0).sum()
    assert series.scans[0].labels is None
    assert series.root is None


def test_only_each_nth_scan(make_images: FolderMaker) -> None:
    folder = make_images(names=tuple(f"000_{k:02}" for k in range(5)))
    series = read_series([folder], Options(every=2))
    assert [scan.name for scan in series.scans] == [f"rgb_000_{k:02}.png" for k in (0, 2, 4)]
    assert series.findings[0].found.endswith("of 5 scans 3, one in 2")
    with pytest.raises(InputError, match="of 5 scans, --every 5 leaves only the first one"):
        read_series([folder], Options(every=5))
    with pytest.raises(InputError, match="every is 0; at least 1 is needed"):
        Options(every=0)


@pytest.mark.parametrize(
    ("names", "times"),
    [
        (("00_000_00", "00_000_05", "00_010_02"), [0, 5 / 6, 10 + 2 / 6]),
        (("2020-03-08", "2020-03-09T12-00", "2020-03-10"), [0, 1.5, 2]),
        (("day2", "day10", "day3.5"), [2, 3.5, 10]),
        (("seedling1", "seedling2", "seedling10"), [0, 1, 2]),
    ],
)
def test_times_from_names(
    make_images: FolderMaker, names: tuple[str, ...], times: list[float]
) -> None:
    series = read_series([make_images(names=names)])
    found = np.array([scan.time for scan in series.scans])
    if names[0].startswith("2020"):
        found -= found[0]
    np.testing.assert_allclose(found, times)


def test_the_rule_names_the_first_and_the_last(make_images: FolderMaker) -> None:
    rule = read_series([make_images(names=("000_00", "000_03", "002_03"))]).findings[0].found
    assert rule == "day 0.00 to day 2.50, from day and number in the names, 6 images a day"


def test_times_from_a_file(make_images: FolderMaker, tmp_path: Path) -> None:
    folder = make_images()
    times = tmp_path / "times.txt"
    times.write_text("rgb_000_00.png 5\nrgb_000_03 4\nrgb_001_00.png 7\n")
    series = read_series([folder], Options(times=times))
    assert [(scan.name, scan.time) for scan in series.scans] == [
        ("rgb_000_03.png", 4.0),
        ("rgb_000_00.png", 5.0),
        ("rgb_001_00.png", 7.0),
    ]


WIDE = np.zeros((30, 41), np.uint16)
SMOOTH = np.random.default_rng(0).integers(0, 256, (*SIZE, 3)).astype(np.uint8)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"camera": None}, "holds images, but no camera.toml .* needs at least fx, fy, cx and cy"),
        ({"names": ("000_00",)}, "holds fewer than two colour images"),
        ({"without": "rgb_*.png"}, r"holds fewer than two colour images 'rgb_\*.png'"),
        ({"without": "depth_000_03.png"}, "no depth image; 'depth_000_03.png' is missing"),
        ({"without": "depth_*.png"}, "no depth image; 'depth_000_00.png' is missing"),
        ({"without": "label_000_03.png"}, "no label image; 'label_000_03.png' is missing"),
        ({"extra": {"depth_000_03.png": WIDE}}, "is 41x30 pixels, but 'rgb_000_03.png' is 40x30"),
        ({"extra": {"label_000_03.png": WIDE}}, "is 41x30 pixels, but 'rgb_000_03.png' is 40x30"),
        ({"extra": {"mask_000_03.png": WIDE}}, "is 41x30 pixels, but 'rgb_000_03.png' is 40x30"),
        ({"extra": {"depth_000_03.png": SMOOTH}}, "a depth image has .* 16 bits .* 'RGB'"),
        (
            {"extra": {"depth_000_03.png": np.zeros(SIZE, np.uint8)}},
            "a depth image has .* 16 bits a pixel, not the kind 'L'",
        ),
        ({"extra": {"label_000_03.png": SMOOTH}}, "1200 distinct colours; a label image needs"),
        (
            {"extra": {"label_000_03.png": np.zeros(SIZE, np.uint8)}},
            "'.*label_000_03.png' shows no plant: no labelled pixel has a depth",
        ),
        (
            {"camera": CAMERA + "width = 99\n"},
            "is 40x30 pixels, not of the width and height in '.*camera.toml'",
        ),
        ({"names": ("000_00", "000_06")}, "is number 6 of its day, of 6 from 0 on; set per_day"),
        ({"names": ("00_000_00", "01_000_00")}, "have the same time, day 0.00"),
        ({"names": ("000_00", "00_00")}, "have the same time, day 0.00"),
        (
            {"extra": {"depth_000_00.png": np.where(leaf(0), 360, 0).astype(np.uint16)}},
            "no depth beside the plant; set ground",
        ),
    ],
)
def test_what_can_not_be_read(make_images: FolderMaker, how: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_series([make_images(**how)])


@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n\x1a\n nonsense", b"hello"])
@pytest.mark.parametrize("what", ["rgb", "depth", "label"])
def test_an_unreadable_image(make_images: FolderMaker, what: str, content: bytes) -> None:
    folder = make_images()
    (folder / f"{what}_000_03.png").write_bytes(content)
    with pytest.raises(InputError, match=rf"{what}_000_03.png' can't be read as an image"):
        read_series([folder])


def test_a_truncated_image(make_images: FolderMaker) -> None:
    folder = make_images(extra={"rgb_000_03.png": SMOOTH})
    path = folder / "rgb_000_03.png"
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(InputError, match=r"rgb_000_03.png' can't be read as an image"):
        read_series([folder])


def test_label_fields_are_for_other_scans(make_images: FolderMaker) -> None:
    with pytest.raises(InputError, match="leave out --label-field"):
        read_series([make_images()], Options(label_field="organ"))
