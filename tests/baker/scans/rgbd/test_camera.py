"""The camera's file: what it may say, and what is said about it when it can't be used."""

import json
from pathlib import Path

import pytest

from baker.errors import InputError
from baker.scans.rgbd.camera import (
    Camera,
    Patterns,
    find_camera,
    read_camera,
)

FULL = """
fx = 610
fy = 611.5
cx = 239.5
cy = 179.5
width = 480
height = 360
depth_unit = 0.125
crop = [80, 60]
ground = 500
background = 0x0000ff
per_day = 24
[images]
color = "rgbd_plant/rgb_00_*.png"
"""


def test_every_field_is_read(tmp_path: Path) -> None:
    path = tmp_path / "camera.toml"
    path.write_text(FULL)
    assert read_camera(path) == Camera(
        fx=610.0,
        fy=611.5,
        cx=239.5,
        cy=179.5,
        width=480,
        height=360,
        depth_unit=0.125,
        crop=(80, 60),
        ground=500.0,
        background=0x0000FF,
        per_day=24,
        images=Patterns(color="rgbd_plant/rgb_00_*.png"),
    )


def test_four_numbers_are_enough_and_json_will_do(tmp_path: Path) -> None:
    path = tmp_path / "camera.json"
    path.write_text(json.dumps({"fx": 1, "fy": 2, "cx": 3, "cy": 4}))
    assert find_camera(tmp_path) == path
    assert read_camera(path) == Camera(1.0, 2.0, 3.0, 4.0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("fx = 610", ""), "missing required field `fx`"),
        (("fx = 610", "fx = -1"), "fx is -1; Expected `float` >= 1e-09"),
        (("fx = 610", 'fx = "wide"'), "fx is 'wide'; Expected `float`"),
        (("fx = 610", "fx = nan"), "fx is nan"),
        (("fx = 610", "fx ="), "is not valid TOML"),
        (("width = 480", "widht = 480"), "unknown field `widht`"),
        (("color = ", "colors = "), "images is .*unknown field `colors`"),
        (("per_day = 24", "per_day = 0.5"), "per_day is 0.5; Expected `int`"),
        (("width = 480", "width = 0"), "width is 0; Expected `int` >= 1"),
        (("[80, 60]", "[80]"), r"crop is \[80\]; Expected `array` of length 2"),
        (("0.125", '"1 mm"'), "depth_unit is '1 mm'; Expected `float`"),
        (("0.125", "0"), "depth_unit is 0; Expected `float` >= 1e-09"),
        (("0x0000ff", '"blue"'), "background is 'blue'; Expected `int`"),
        (("rgb_00_*", "rgb_00"), r"images is .*color': .*color a path in the folder, with one \*"),
        (("rgbd_plant/", "../"), "images is .*color a path in the folder"),
    ],
)
def test_what_can_not_be_used(tmp_path: Path, change: tuple[str, str], said: str) -> None:
    path = tmp_path / "camera.toml"
    assert change[0] in FULL
    path.write_text(FULL.replace(*change))
    with pytest.raises(InputError, match=said):
        read_camera(path)
