"""What is put right by hand changes the next bake, and nothing but what it says."""

from __future__ import annotations

from io import StringIO
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import KDTree

import gclip
from baker import InputError, bake
from baker.cli import main
from baker.matching.corrections import PointCorrection, with_corrected_organs
from corrections import Correction, Place, write_corrections
from gclip import Clip
from traits import NamedPlant, write_table

PLAIN = {"align": "none", "up": "z", "paths": "straight", "workers": 1}


@pytest.fixture
def folder(write_scans) -> Path:
    return write_scans(days=(0, 1, 2, 3))


def relabel(folder: Path, day: int, labels: dict[int, int]) -> None:
    """Give organs of one scan other labels."""
    table = np.loadtxt(folder / f"day{day:02d}.txt")
    table[:, 3] = [labels.get(int(label), label) for label in table[:, 3]]
    np.savetxt(folder / f"day{day:02d}.txt", table, fmt="%.4f")


def organ(folder: Path, day: int, label: int) -> np.ndarray:
    table = np.loadtxt(folder / f"day{day:02d}.txt")
    return table[table[:, 3] == label, :3]


def place(folder: Path, day: int, label: int) -> Place:
    points = organ(folder, day, label)
    x, y, z = points[np.linalg.norm(points - points.mean(axis=0), axis=1).argmin()].tolist()
    return Place(f"day{day:02d}.txt", (x, y, z))


def track(clip: Clip, day: int, points: np.ndarray) -> str:
    """The organ that has these points on a day, but for a few that touch others."""
    frame = clip.at(day)
    tracks, counts = np.unique(
        frame.tracks[KDTree(frame.positions).query(points)[1]], return_counts=True
    )
    assert counts.max() >= 0.9 * len(points)
    return clip.track_table[tracks[counts.argmax()]].name


def movers(clip: Clip) -> list[bytes]:
    return [np.asarray(b).tobytes() for i in clip.intervals for b in i.buffers().values()]


def test_the_same_organ_under_another_label_is_the_same_again(folder):
    truth = bake(folder, **PLAIN, labels="consistent")
    for day in (2, 3):
        relabel(folder, day, {1: 2, 2: 1})
    wrong = bake(folder, **PLAIN, labels="consistent")
    same = Correction("same", (place(folder, 1, 1), place(folder, 2, 2)))
    right = bake(folder, **PLAIN, labels="consistent", corrections=[same])
    assert movers(right) == movers(truth) != movers(wrong)
    assert right.track_table == truth.track_table
    # As good where the places are the other way round, or scans apart.
    (first, _), last = same.places, place(folder, 3, 2)
    for places in ((last, first), (first, last)):
        again = bake(folder, **PLAIN, labels="consistent", corrections=[Correction("same", places)])
        assert track(again, 3, organ(folder, 3, 2)) == "leaf 1"


@pytest.mark.parametrize("labels", ["consistent", "independent", "ignore"])
def test_organs_that_are_not_the_same_part(folder, labels):
    options = PLAIN | {"labels": labels}
    stem = [place(folder, day, 0) for day in (1, 2)]
    before = bake(folder, **options)
    assert track(before, 1, [stem[0].point]) == track(before, 2, [stem[1].point])
    after = bake(folder, **options, corrections=[Correction("different", (stem[0], stem[1]))])
    assert track(after, 1, [stem[0].point]) != track(after, 2, [stem[1].point])
    for time in before.times:  # every point of the scans is still there
        points = (clip.at(time).positions for clip in (before, after))
        assert KDTree(next(points)).query(next(points))[0].max() < 1e-3


def test_followed_organs_heed_what_is_the_same(folder):
    for day in range(4):
        relabel(folder, day, {1: 7 + day, 2: 21 - day})
    wrong = Correction("same", (place(folder, 1, 8), place(folder, 2, 19)))
    clip = bake(folder, **PLAIN, labels="independent", corrections=[wrong])
    assert track(clip, 1, organ(folder, 1, 8)) == track(clip, 2, organ(folder, 2, 19))


def test_organs_of_one_scan_are_joined_and_parted(folder):
    both = place(folder, 2, 1), place(folder, 2, 2)
    joined = bake(folder, **PLAIN, labels="consistent", corrections=[Correction("same", both)])
    points = [organ(folder, 2, label) for label in (1, 2)]
    assert track(joined, 2, points[0]) == track(joined, 2, points[1]) == "leaf 1"
    relabel(folder, 2, {2: 1})
    parted = Correction("different", both)
    again = Correction("same", (place(folder, 1, 2), both[1]))
    clip = bake(folder, **PLAIN, labels="consistent", corrections=[again, parted])
    names = [track(clip, 2, part[np.argsort(part[:, 2])[-20:]]) for part in points]
    assert names == ["leaf 1", "leaf 2"]


@pytest.mark.parametrize("count", [300, 4000])
def test_blades_that_touch_part_where_they_touch(count):
    rng = np.random.default_rng(4)
    angle, radius = rng.uniform(0, 2 * np.pi, 2 * count), 5.0 * np.sqrt(rng.random(2 * count))
    blade = np.repeat([0, 1], count)
    cloud = np.column_stack(
        [radius * np.cos(angle), radius * np.sin(angle), 0.1 * rng.random(2 * count)]
    )
    cloud += blade[:, None] * [9.5, 0.0, 1.0]  # the second over the edge of the first
    places = [
        int(np.linalg.norm(cloud - middle, axis=1).argmin()) for middle in ([1, 2, 0], [11, 1, 1])
    ]
    apart = PointCorrection("", "different", tuple((0, point) for point in places))
    aligned = SimpleNamespace(clouds=[cloud.astype(np.float32)])
    (labels,) = with_corrected_organs([np.full(2 * count, 7)], aligned, [apart])
    assert set(labels.tolist()) == {7, 8}
    assert ((labels == 8) == (blade == 1)).mean() > 0.99


def test_a_cut_takes_off_what_lies_beyond(folder):
    points = organ(folder, 2, 1)
    distance = np.linalg.norm(points - organ(folder, 2, 0).mean(axis=0), axis=1)
    order = np.argsort(distance)
    middle = Place("day02.txt", tuple(points[order[len(order) // 2]].tolist()))
    clip = bake(folder, **PLAIN, labels="consistent", corrections=[Correction("cut", (middle,))])
    assert track(clip, 2, points[order[:5]]) == "leaf 1"
    assert track(clip, 2, points[order[-5:]]) not in ("leaf 1", "stem")


def test_names_stay_with_their_organs(folder, tmp_path):
    name = Correction("name", (place(folder, 3, 2),), "flag leaf")
    clip = bake(folder, **PLAIN, labels="independent", corrections=[name])
    assert track(clip, 1, organ(folder, 1, 2)) == "flag leaf"
    assert (clip.tracks["flag leaf"].kind, clip.track_table[0].kind) == ("organ", "stem")


def test_two_organs_of_one_name_are_refused(folder):
    flag, tip = place(folder, 3, 2), place(folder, 3, 1)
    for names in (("flag leaf", "flag leaf"), ("leaf 2", "leaf 2"), ("stem", "leaf 1")):
        both = [
            Correction("name", (at,), name) for at, name in zip((tip, flag), names, strict=True)
        ]
        with pytest.raises(InputError, match=r"Correction [12] \(name\): another organ is called"):
            bake(folder, **PLAIN, labels="consistent", corrections=both)
    swapped = [Correction("name", (tip,), "leaf 2"), Correction("name", (flag,), "leaf 1")]
    clip = bake(folder, **PLAIN, labels="consistent", corrections=swapped)
    assert track(clip, 3, organ(folder, 3, 2)) == "leaf 1"


def test_an_organ_is_called_as_it_was_named(folder):
    # Moved, turned and scaled, as the places are in the coordinates of the scans' files.
    options = PLAIN | {"align": "icp", "scale": 2.0, "labels": "consistent"}
    clip = bake(folder, **options)
    names = [Correction("name", (place(folder, 3, 2),), "flag leaf")]
    named = bake(folder, **options, corrections=names)
    (new,) = {one.name for one in named.track_table} - {one.name for one in clip.track_table}
    assert new == "flag leaf"
    table = StringIO(newline="")
    write_table(table, NamedPlant(named, "p"), [3.0])
    assert "flag leaf" in table.getvalue()


@pytest.mark.parametrize(
    ("said", "places"),
    [
        (
            "'day09.txt', which is not in the series; these are: day00.txt",
            (("day09.txt", 0, 0, 0),),
        ),
        (r"Correction 1 \(cut\): \(0, 0, 999\) is", (("day01.txt", 0, 0, 999),)),
        ("both", ()),
    ],
)
def test_what_can_not_be_is_said(folder, said, places):
    if places:
        ((scan, *point),) = places
        corrections = [Correction("cut", (Place(scan, tuple(point)),))]
    else:
        both = place(folder, 1, 1), place(folder, 2, 1)
        corrections = [Correction("same", both), Correction("different", both)]
        said = r"Correction 1 \(same\) contradicts the others"
    with pytest.raises(InputError, match=said):
        bake(folder, **PLAIN, labels="consistent", corrections=corrections)


def test_bake_finds_them_beside_the_clip(folder, tmp_path, capsys):
    clip, file = tmp_path / "plant.gclip", tmp_path / "plant.corrections.toml"
    words = [str(folder), "-o", str(clip), "--align", "none", "--up", "z", "--cache"]
    command = [*words, str(tmp_path / "cache"), "--force"]
    assert main(command) == 0
    plain = clip.read_bytes()
    capsys.readouterr()
    write_corrections(file, [Correction("name", (place(folder, 3, 2),), "flag leaf")])
    assert main(command) == 0
    said = capsys.readouterr().err
    assert f"corrections: {file}" in said
    assert "put right by hand: 1 name" in said
    assert "3 of 3 intervals" in said  # a name is not solved again
    names = [one.name for one in gclip.open(clip).track_table]
    assert "flag leaf" in names
    assert main([*command, "--corrections", "none"]) == 0
    assert clip.read_bytes() == plain
    write_corrections(file, [Correction("cut", (Place("day00.txt", (0.0, 0.0, 999.0)),))])
    assert main(command) == 2
    assert f"Correction 1 (cut) of '{file}': (0, 0, 999) is" in capsys.readouterr().err
    file.write_text("[[correction]]\nkind = 'cut'\n")
    assert main(command) == 2
    assert "correction 1" in capsys.readouterr().err
    assert clip.read_bytes() == plain


@pytest.mark.parametrize(("day", "kept"), [(0, 0), (1, 1), (2, 2)])
def test_intervals_before_a_correction_are_not_solved_again(folder, tmp_path, capsys, day, kept):
    words = [str(folder), "-o", str(tmp_path / "plant.gclip"), "--align", "none", "--up", "z"]
    command = [*words, "--paths", "straight", "--cache", str(tmp_path / "cache"), "--force"]
    assert main(command) == 0
    apart = Correction("different", (place(folder, day, 1), place(folder, day + 1, 1)))
    write_corrections(tmp_path / "plant.corrections.toml", [apart])
    capsys.readouterr()
    assert main(command) == 0
    assert f"{kept} of 3 intervals" in capsys.readouterr().err
    with_cache = (tmp_path / "plant.gclip").read_bytes()
    assert main([word for word in command if word not in ("--cache", str(tmp_path / "cache"))]) == 0
    assert (tmp_path / "plant.gclip").read_bytes() == with_cache
