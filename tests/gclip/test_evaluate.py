"""Clip.at: scans are kept, order is constant, curves are Bézier curves."""

from dataclasses import replace

import numpy as np
import pytest

from gclip import Clip, Motion
from gclip.evaluate import LITTER_FADE, bernstein, layers_at, newborn, palette_at


def sorted_rows(points: np.ndarray) -> np.ndarray:
    return points[np.lexsort(points.T)]


def scan_points(clip: Clip, index: int) -> np.ndarray:
    rng = np.random.default_rng(7)
    scans = [rng.random((300, 3)) * 100 for _ in range(3)]
    return scans[index] if index < 2 else scans[2][:150]


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("precision", ["auto", "float32"])
@pytest.mark.parametrize("lost", [Motion.FALL, Motion.FADE, Motion.REMOVE])
def test_scans_come_back_as_sets(make_clip, degree, precision, lost):
    clip = make_clip(degree=degree, precision=precision, lost=lost)
    step = 100 / 65535 if precision == "auto" else 1e-5
    for index, time in enumerate(clip.times):
        found, truth = clip.at(time).positions, scan_points(clip, index)
        assert found.shape == truth.shape
        nearest = np.abs(found[:, None] - truth[None]).max(axis=2)
        assert nearest.min(axis=1).max() <= step
        assert nearest.min(axis=0).max() <= step


def test_order_is_constant_within_an_interval(make_clip):
    clip = make_clip()
    early, late = clip.at(0.5), clip.at(1.5)
    assert np.array_equal(early.tracks, late.tracks)
    middle = (early.positions + late.positions) / 2
    assert np.allclose(clip.at(1.0).positions, middle, atol=1e-3)


def test_curves_pass_where_bezier_says(make_clip):
    clip = make_clip(degree=3, precision="float32")
    interval, u = clip.intervals[0], 0.3
    a, b, c, d = (points.astype(float) for points in interval.curve)
    # De Casteljau's construction, independent of the Bernstein weights.
    ab, bc, cd = a + u * (b - a), b + u * (c - b), c + u * (d - c)
    abc, bcd = ab + u * (bc - ab), bc + u * (cd - bc)
    assert np.allclose(clip.at(2.0 * u).positions, abc + u * (bcd - abc), atol=1e-4)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_weights_sum_to_one(degree):
    for u in np.linspace(0, 1, 11):
        assert np.isclose(bernstein(degree, u).sum(), 1.0)


def test_lost_organ_falls_with_gravity_and_its_litter_fades(make_clip):
    clip = make_clip(lost=Motion.FALL)
    heights = [clip.at(t).positions[150:, 2] for t in (2.0, 3.5, 5.0 - 1e-9)]
    assert np.allclose(heights[1], 0.75 * heights[0], atol=1e-2)  # half the time, a quarter down
    assert np.allclose(heights[2], 0.0, atol=1e-2)
    assert len(clip.at(5.0)) == 150
    litter = clip.at(5.0).litter
    assert litter is not None
    assert len(litter) == 150


def test_litter_fades_early_in_the_next_interval(make_clip):
    first = make_clip(lost=Motion.FALL)
    falling = Clip(
        scans=(*first.scans, first.scans[-1].__class__("d", 9.0, "day 9", 300)),
        intervals=(
            *first.intervals,
            first.intervals[0].__class__(
                **{**vars(first.intervals[0]), "start": 5.0, "end": 9.0},
            ),
        ),
        track_table=first.track_table,
    )
    alphas = [
        [layer.alpha for layer in layers_at(falling, 5.0 + 4.0 * u) if layer.litter]
        for u in (0.0, LITTER_FADE / 2, LITTER_FADE + 1e-9)
    ]
    assert alphas[0] == [1.0]
    assert np.allclose(alphas[1], [0.5])
    assert alphas[2] == []


def test_fading_and_removed_organs(make_clip):
    fading = make_clip(lost=Motion.FADE).at(3.5)
    assert set(fading.colors[150:, 3]) == {128}
    assert len(make_clip(lost=Motion.REMOVE).at(2.0)) == 300
    assert len(make_clip(lost=Motion.REMOVE).at(2.0 + 1e-6)) == 150


@pytest.mark.parametrize("day", [-0.001, 5.001, float("nan"), float("inf")])
def test_a_time_outside_the_series_is_refused_with_its_range(make_clip, day):
    with pytest.raises(ValueError, match="outside the series, whose days are 0 to 5"):
        make_clip().at(day)


def test_a_frame_says_when_and_how_much(make_clip):
    assert repr(make_clip().at(2.5)) == f"<gclip.Frame: day 2.5, {len(make_clip().at(2.5))} points>"


def test_sums_of_steps_may_end_a_rounding_error_off(make_clip):
    clip, end = make_clip(), 5.0 + 1e-12
    assert np.array_equal(clip.at(end).positions, clip.at(5).positions)


def test_several_times_give_a_frame_each(make_clip):
    clip = make_clip()
    for frame, day in zip(clip.at(np.array([0.0, 1.25, 5.0])), (0.0, 1.25, 5.0), strict=True):
        assert np.array_equal(frame.positions, clip.at(day).positions)
    assert clip.at([]) == []


def test_colors_blend_in_linear_light(make_clip):
    clip = make_clip(colors=True)
    interval = clip.intervals[0]
    assert np.array_equal(clip.at(0.0).colors, interval.start_colors)
    start, end = (c[:, :3] / 255.0 for c in (interval.start_colors, interval.end_colors))
    light = (start**2.2 + end**2.2) / 2  # sRGB is within a few percent of a power of 2.2
    assert np.abs(clip.at(1.0).colors[:, :3] / 255.0 - light ** (1 / 2.2)).max() < 0.04


def test_without_scan_colors_the_track_tells(make_clip):
    frame = make_clip().at(1.0)
    assert np.array_equal(frame.colors[frame.tracks == 1][0], [63, 144, 218, 255])


def test_world_coordinates_are_added(make_clip):
    near, far = make_clip(), make_clip(origin=(1000.0, -745.0, 20.0))
    assert np.allclose(far.at(1.3).positions - near.at(1.3).positions, [1000, -745, 20], atol=1e-3)
    assert np.array_equal(far.at(1.3).local, near.at(1.3).local)


def test_what_is_born_takes_on_its_own_colour_from_that_of_its_parent(make_clip):
    clip = make_clip()
    stem, bud = clip.track_table
    end = clip.intervals[0].end
    grown = replace(clip, track_table=(stem, replace(bud, parent=stem.id, born=end)))
    colors = [palette_at(grown, 0, share)[bud.id, :3] for share in (0.0, 0.5, 1.0)]
    assert colors[0].tolist() == list(stem.color)
    assert colors[2].tolist() == list(bud.color)
    low, high = np.minimum(colors[0], colors[2]), np.maximum(colors[0], colors[2])
    assert ((colors[1] >= low) & (colors[1] <= high)).all()
    assert (palette_at(grown, 1, 0.0) == clip.palette).all(), "from then on it has its own"


def test_a_newborn_branch_comes_from_what_was_there(make_clip):
    clip = make_clip()
    stem, end = clip.track_table[0], clip.intervals[0].end
    branch = replace(clip.track_table[1], parent=0, born=end)
    leaf = replace(branch, id=2, parent=1)
    assert newborn(replace(clip, track_table=(stem, branch, leaf)), 0) == {1: 0, 2: 0}
    circle = (stem, replace(branch, parent=2), leaf)
    assert newborn(replace(clip, track_table=circle), 0) == {}, "a forged clip may say so"
