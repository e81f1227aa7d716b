"""What lies in a folder of scans."""

import os

import pytest

from baker.errors import InputError
from baker.scans.find import find_scans


def test_links_to_files_that_are_not_there_are_named(make_folder):
    folder = make_folder({"day1.ply": "", "day2.ply": "", "day3.ply": ""})
    (folder / "day4.ply").symlink_to(folder / "annex" / "day4.ply")
    with pytest.raises(InputError, match=r"day4\.ply' can't be read: No such file"):
        find_scans([folder])
    (folder / "day4.ply").unlink()
    (folder / ".#day4.ply").symlink_to("as an editor does")
    assert len(find_scans([folder])) == 3


def test_pipes_named_as_scans_are_named(make_folder):
    folder = make_folder({"day1.ply": "", "day2.ply": ""})
    os.mkfifo(folder / "day3.ply")
    with pytest.raises(InputError, match=r"day3\.ply' is not a regular file"):
        find_scans([folder])


def test_gzipped_scans_are_one_series_with_plain_ones(make_folder):
    folder = make_folder({"day1.ply": "", "day2.ply.gz": "", "notes.gz": "", "day3.tar.gz": ""})
    assert [path.name for path in find_scans([folder])] == ["day1.ply", "day2.ply.gz"]


def test_notes_beside_numbered_scans_are_passed_over(make_folder):
    scans = {"day1.ply": "", "day2.ply": ""}
    found = find_scans([make_folder(scans | {"notes.txt": "", "meta.csv": "", "log.txt": ""})])
    assert [path.name for path in found] == list(scans)
    with pytest.raises(InputError, match=r"'day1\.ply' and 'final\.ply', which names no day"):
        find_scans([make_folder(scans | {"final.ply": ""}, "unnumbered")])
    with pytest.raises(InputError, match="more than one series"):
        find_scans([make_folder(scans | {"day3.txt": ""}, "mixed")])
    named = {"young.ply": "", "old.ply": "", "oldest.txt": ""}
    with pytest.raises(InputError, match="more than one series"):
        find_scans([make_folder(named, "named")])


def test_meshes_and_arrays_beside_point_clouds_are_passed_over(make_folder):
    clouds = {"day1.ply": "", "day2.ply": ""}
    others = {"day1.obj": "", "day2.obj": "", "day2.npy": ""}
    found = find_scans([make_folder(clouds | others)])
    assert [path.name for path in found] == list(clouds)
    with pytest.raises(InputError, match="more than one series"):
        find_scans([make_folder({"day1.ply": "", **others}, "mixed")])
    found = find_scans([make_folder({"day1.obj": "", "day2.obj": ""}, "meshes")])
    assert [path.name for path in found] == ["day1.obj", "day2.obj"]
