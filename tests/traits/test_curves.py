"""Curves of organs: they are the table's values, and their picture says which are sure."""

from pathlib import Path
from xml.etree import ElementTree

import pytest

from baker import Options, bake
from gclip import Clip
from grow.series import Plan, write_series
from traits import measure
from traits.curves import curve_svg, trait_curves


@pytest.fixture(scope="module")
def grown(tmp_path_factory: pytest.TempPathFactory) -> Clip:
    folder: Path = tmp_path_factory.mktemp("maize") / "scans"
    write_series(Plan("maize", seed=1, scans=3, days=6, points=(800, 1500)), folder)
    return bake([folder], Options(align="none", up="z", unit="mm", workers=1))


def test_curves_are_what_the_table_says(grown: Clip) -> None:
    curves = {(one.track, one.trait): one for one in trait_curves(grown)}
    assert {trait for _, trait in curves} == {"length", "area", "angle"}
    for index, day in enumerate(grown.times):
        for one in measure(grown, day)[1:]:
            curve = curves[one.track, "length"]
            place = curve.times.index(day)
            assert curve.values[place] == one.length
            assert curve.sure[place] == ("length" in one.sure)
            assert curve.margins[place] == pytest.approx(
                one.length * (0.05 if curve.sure[place] else 0.15)
            )
            assert place <= index, "days before birth have no value"
    for track in range(len(grown.track_table)):
        assert trait_curves(grown, [track]) == [c for c in curves.values() if c.track == track]


def test_a_picture_of_a_curve_is_sound_and_within_its_frame(grown: Clip) -> None:
    for curve in trait_curves(grown):
        picture = ElementTree.fromstring(curve_svg(curve, (0.0, 6.0), "rgb(1,2,3)"))
        dots = picture.findall("g/path")
        assert [dot.get("opacity") == "1.0" for dot in dots] == list(curve.sure)
        for dot in dots:
            x, y = map(float, dot.get("d")[1:-2].split(","))
            assert 0.0 <= x <= 320.0
            assert 0.0 <= y <= 84.0
