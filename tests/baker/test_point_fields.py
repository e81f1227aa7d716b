"""Scalar fields of scans: from their files into the clip, its colours and the table of traits."""

import csv
from io import StringIO
from pathlib import Path

import numpy as np
import pytest

import gclip
import player
from baker import InputError, Options, bake
from gclip import Clip
from grow import plant
from player.view.colors import Colors
from player.view.style import ColorMode, Style
from traits import NamedPlant, write_table
from traits.curves import curve_names, trait_curves
from traits.fields import field_means

OPTIONS = Options(align="none", up="z", unit="mm", workers=1, fields="ndvi,layer")


@pytest.fixture(scope="module")
def scans(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """`layer` looks like labels, and isn't; on the second day it tells the time."""
    folder = tmp_path_factory.mktemp("scans")
    for day in (4, 8):
        cloud = plant("maize", 0).cloud(float(day), 900, noise=0.0, colors=False)
        ndvi = 0.01 * cloud.points[:, 2]
        table = np.column_stack([cloud.points, cloud.labels, ndvi, np.full(len(ndvi), day)])
        head = "x,y,z,label,NDVI,layer"
        np.savetxt(folder / f"day{day}.csv", table, "%.7g", ",", header=head, comments="")
    return folder


@pytest.fixture(scope="module")
def clip(scans: Path) -> Clip:
    return bake([scans], OPTIONS)


def test_points_keep_their_values_at_both_ends(clip: Clip, scans: Path) -> None:
    assert clip.fields == ("ndvi", "layer")
    (interval,) = clip.intervals
    values, layers = interval.fields
    born = np.array([track.born for track in clip.track_table])[interval.tracks] > 4.0
    assert born.any()
    # What is born has the second scan's values throughout.
    assert (layers[~born] == [4.0, 8.0]).all()
    assert (layers[born] == 8.0).all()
    height = clip.at(8.0).local[:, 2]
    assert values[:, 1] == pytest.approx(0.01 * height, abs=1e-3)


def test_a_clip_keeps_its_fields_in_its_file(clip: Clip, tmp_path: Path) -> None:
    clip.save(tmp_path / "a.gclip")
    again = gclip.open(tmp_path / "a.gclip")
    assert clip.fields == again.fields
    for before, after in zip(clip.intervals, again.intervals, strict=True):
        assert np.array_equal(before.fields, after.fields, equal_nan=True)


def test_means_are_those_of_the_scans_points(clip: Clip, scans: Path) -> None:
    table = np.loadtxt(scans / "day8.csv", delimiter=",", skiprows=1)
    assert field_means(clip, 8.0)["ndvi"] == pytest.approx(table[:, 4].mean(), rel=1e-4)
    stem = clip.tracks["stem"].id
    own = table[table[:, 3] == 0, 4].mean()
    assert field_means(clip, 8.0, stem)["ndvi"] == pytest.approx(own, rel=1e-2)
    assert field_means(clip, 5.0, stem)["layer"] == pytest.approx(5.0)
    text = StringIO(newline="")
    write_table(text, NamedPlant(clip, "p"), [8.0])
    rows = list(csv.DictReader(StringIO(text.getvalue())))
    found = [r for r in rows if r["trait"] == "mean_ndvi" and r["organ"] == "stem"]
    assert float(found[0]["value"]) == pytest.approx(own, rel=1e-2)


def test_points_of_a_frame_have_values(clip: Clip) -> None:
    born = np.array([track.born for track in clip.track_table]) > 4.0
    for day in (4.0, 5.0, 8.0):
        frame = clip.at(day)
        assert set(frame.fields) == {"ndvi", "layer"}
        assert frame.fields["layer"].dtype == np.float32
        assert frame.fields["layer"] == pytest.approx(np.where(born[frame.tracks], 8.0, day))
    assert frame.fields["ndvi"] == pytest.approx(0.01 * frame.local[:, 2], abs=1e-3)


def test_mean_fields_of_organs_are_plotted(clip: Clip, tmp_path: Path) -> None:
    curves = {(one.track, one.trait): one for one in trait_curves(clip)}
    assert curve_names(clip) == ["length", "area", "angle", "mean ndvi", "mean layer"]
    stem = clip.tracks["stem"].id
    ndvi, layer = curves[stem, "mean ndvi"], curves[stem, "mean layer"]
    assert layer.values == (4.0, 8.0)
    assert (layer.bottom, layer.top, layer.level(6.0)) == (4.0, 8.0, 0.5)
    assert ndvi.values == tuple(field_means(clip, day, stem)["ndvi"] for day in clip.times)
    player.film(clip, str(tmp_path / "page.html"))
    page = (tmp_path / "page.html").read_text()
    assert f'"{stem} mean layer":["mean layer, 4 to 8"' in page


def test_fields_are_colours_with_a_legend(clip: Clip) -> None:
    style = Style(color_by=ColorMode.FIELD, field="ndvi")
    scale = Colors(clip).value_range(style)
    assert scale is not None
    assert scale.title == "ndvi"
    values, ramp = clip.intervals[0].fields[0][:, 1], scale.colors().astype(int)
    worn = Colors(clip).clip_with_colors(style).intervals[0].end_colors
    assert worn is not None
    steps = np.clip((values - scale.low) / (scale.high - scale.low), 0, 1) * (len(ramp) - 1)
    assert np.abs(worn[:, :3] - ramp[np.round(steps).astype(int)]).max() == 0


def test_a_field_that_a_scan_lacks_is_named(scans: Path) -> None:
    with pytest.raises(InputError, match=r"day4.csv' has no field 'heat'; the fields found: x, y"):
        bake([scans], Options(fields="ndvi,heat"))
