"""Images baked in one command: no alignment, all organs under a virtual, empty root."""

from pathlib import Path

import numpy as np
import pytest

import gclip
from baker.cli import main
from baker.scans.read import read_series
from grow.images import ImagePlan, write_images


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rgbd") / "images"
    write_images(ImagePlan(days=3, per_day=2, size=(160, 120)), folder)
    return folder


def test_a_folder_of_images_bakes(folder: Path, tmp_path: Path) -> None:
    output = tmp_path / "komatsuna.gclip"
    assert main([str(folder), "-o", str(output), "-q"]) == 0
    clip = gclip.open(output)
    assert clip.up == "z"
    np.testing.assert_allclose(clip.times, [0, 0.5, 1, 1.5, 2, 2.5])
    root, *leaves = clip.track_table
    assert root.kind == "root"
    assert {leaf.parent for leaf in leaves} == {root.id}
    assert clip.provenance["options"]["align"] == "none"
    assert any("filled by convolution" in note for note in clip.provenance["notes"])
    assert clip.unit == "mm"

    from scipy.spatial import cKDTree

    # Nothing was moved, and no point belongs to the empty root.
    scan = read_series([folder]).scans[2]
    frame = clip.at(1.0)
    assert root.id not in frame.tracks
    for one, other in ((frame.positions, scan.points), (scan.points, frame.positions)):
        assert cKDTree(one).query(other)[0].max() < 0.01


def test_only_each_nth(folder: Path, tmp_path: Path) -> None:
    output = tmp_path / "komatsuna.gclip"
    assert main([str(folder), "-o", str(output), "-q", "--every", "2"]) == 0
    np.testing.assert_allclose(gclip.open(output).times, [0, 1, 2])
