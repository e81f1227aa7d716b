"""A click on an organ names a point of the scan that it is seen in, in the file's own frame."""

from dataclasses import replace

import numpy as np
import pytest

from corrections.provenance import baked_corrections
from gclip import Clip
from player.view.camera import Camera
from player.view.organ_place import organ_place
from tests.player.shown import small_clip

FORGED = [10**400, "x", float("nan"), float("inf"), [], {}]
TURN = [[0.0, -1.0, 0.0, 5.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, -2.0], [0.0, 0.0, 0.0, 1.0]]


@pytest.fixture
def clip() -> Clip:
    """Baked from scans a tenth as large, turned and shifted."""
    clip = small_clip()
    made = {
        "inputs": [{"name": scan.name} for scan in clip.scans],
        "transforms": [TURN for _ in clip.scans],
        "origins": [[100.0, 0.0, 0.0] for _ in clip.scans],
        "options": {"scale": 10.0, "corrections": []},
    }
    return replace(clip, origin=(100.0, 0.0, 0.0), provenance=made)


def in_clip(point: tuple[float, float, float]) -> np.ndarray:
    local = 10.0 * np.array(point) - [100.0, 0.0, 0.0]
    return (np.array(TURN) @ [*local, 1.0])[:3]


@pytest.mark.parametrize(("day", "scan"), [(0.0, 0), (0.9, 0), (1.1, 1), (3.0, 2)])
def test_a_place_is_a_point_of_the_organ_in_the_nearest_scan(
    clip: Clip, day: float, scan: int
) -> None:
    place = organ_place(clip, 1, day)
    assert place is not None
    assert (place.scan, place.organ) == (clip.scans[scan].name, "leaf")
    frame = clip.at(clip.scans[scan].time)
    distances = np.linalg.norm(frame.local - in_clip(place.point), axis=1)
    assert distances.min() < 1e-5
    assert frame.tracks[distances.argmin()] == 1


def test_a_click_means_what_is_in_front(clip: Clip) -> None:
    camera, aspect = Camera.home(clip, 1.5), 1.5
    frame = clip.at(0.0)
    right, up, depth, scale = camera.matrix(aspect) @ np.c_[frame.local, np.ones(len(frame))].T
    for target in np.flatnonzero(frame.tracks == 1)[:20]:
        at = float(right[target] / scale[target]), float(up[target] / scale[target])
        place = organ_place(clip, 1, 0.0, (camera, aspect, at))
        assert place is not None
        found = np.linalg.norm(frame.local - in_clip(place.point), axis=1).argmin()
        away = np.hypot(1.5 * (right / scale - at[0]), up / scale - at[1])[found]
        assert away < 0.03
        assert (depth / scale)[found] <= (depth / scale)[target] + 1e-9


@pytest.mark.parametrize(
    "said",
    [
        {},
        {"inputs": 5, "options": []},
        {"inputs": [{"name": "2020-03-08"}], "transforms": [[[0.0]]], "options": {"scale": 1}},
        {"inputs": [{"name": "2020-03-08"}], "transforms": [np.zeros((4, 4)).tolist()]},
        {"options": {"corrections": [{"kind": "trim"}]}},
        {"options": {"corrections": {"a": 1}}},
    ],
    ids=str,
)
def test_a_clip_that_says_nothing_of_it_or_nonsense_is_taken_as_it_is(said: dict) -> None:
    clip = replace(small_clip(), provenance=said)
    place = organ_place(clip, 0, 0.0)
    assert place is not None
    assert np.linalg.norm(clip.at(0.0).positions - place.point, axis=1).min() < 1e-5
    assert baked_corrections(clip) == ()


@pytest.mark.parametrize("forged", FORGED, ids=lambda value: str(value)[:8])
@pytest.mark.parametrize("field", ["transforms", "origins", "number", "scale", "options"])
def test_provenance_may_hold_anything(clip: Clip, field: str, forged: object) -> None:
    usual = organ_place(replace(clip, provenance={}), 1, 0.0)
    said = dict(clip.provenance)
    if field == "number":
        said["transforms"] = [[[forged, 0.0, 0.0, 5.0], *TURN[1:]]] * len(clip.scans)
    elif field == "scale":
        said["options"] = {"scale": forged}
    else:
        said[field] = forged if field == "options" else [forged] * len(clip.scans)
    assert organ_place(replace(clip, provenance=said), 1, 0.0) == usual
    assert baked_corrections(replace(clip, provenance=said)) == ()
