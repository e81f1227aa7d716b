"""Which files are a series, in which order, at which times."""

import random
from datetime import date, timedelta
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from baker.errors import InputError
from baker.scans.find import find_scans
from baker.scans.times.schedule import natural_key, schedule_scans


def schedule(*names, from_folder=True, times_file=None):
    return schedule_scans(list(map(Path, names)), times_file, from_folder=from_folder)


def times(*names, **options):
    return [scan.time for scan in schedule(*names, **options).scans]


def gaps(*names, **options):
    found = times(*names, **options)
    return [time - found[0] for time in found]


@pytest.mark.parametrize(
    ("names", "expected", "unit"),
    [
        (["2020-03-08.ply", "2020-03-10.ply"], [0, 2], "days"),
        (["2019-12-31.ply", "2020-03-01.ply"], [0, 61], "days"),
        (["maize_20200308.txt", "maize_20200309.txt"], [0, 1], "days"),
        (["a 2020_03_08.las", "a 2020_03_10.las"], [0, 2], "days"),
        (["2020-03-08T14-30.ply", "2020-03-08T20-30.ply"], [0, 0.25], "days"),
        (["20200308_1430.ply", "20200309_0230.ply"], [0, 0.5], "days"),
        (["2020-03-08.ply", "2020-03-09T12-00.ply"], [0, 1.5], "days"),
        (["2020-03-08_9999.ply", "2020-03-09_9998.ply"], [0, 1], "days"),
        (["day00.txt", "day05.txt"], [0, 5], "days"),
        (["day9.txt", "day10.txt"], [0, 1], "days"),
        (["plant_D2.txt", "plant_D12.txt"], [0, 10], "days"),
        (["p1-d2.5.txt", "p1-d4.txt"], [0, 1.5], "days"),
        (["Day 1.ply", "Day 3.ply"], [0, 2], "days"),
        (["DAS12.ply", "DAS20.ply"], [0, 8], "days"),
        (["2020-03-01_day05.ply", "2020-03-01_day07.ply"], [0, 2], "days"),
        (["a/2020-03-08/scan.ply", "a/2020-03-11/scan.ply"], [0, 3], "days"),
        (["scan9.ply", "scan10.ply"], [0, 1], "scans"),
        (["a.ply", "b.ply"], [0, 1], "scans"),
        (["scan3D_7.ply", "scan3D_9.ply"], [0, 1], "scans"),
        (["2020-13-40.ply", "2020-14-50.ply"], [0, 1], "scans"),
        (["id5.ply", "id7.ply"], [0, 1], "scans"),
    ],
)
def test_times_from_names(names, expected, unit):
    found = schedule(*reversed(names))
    assert [scan.path for scan in found.scans] == [Path(name) for name in names]
    assert gaps(*reversed(names)) == pytest.approx(expected)
    assert found.unit == unit
    assert found.findings[0].topic == ("days" if unit == "days" else "order")


@given(st.sets(st.dates(date(1900, 1, 1), date(2199, 12, 31)), min_size=2, max_size=8))
def test_all_dates_are_ordered_with_their_true_gaps(dates):
    ordered = sorted(dates)
    names = [f"{day.isoformat()}.ply" for day in ordered]
    random.Random(0).shuffle(names)
    assert gaps(*names) == [(day - ordered[0]) / timedelta(days=1) for day in ordered]


@given(st.sets(st.integers(0, 999), min_size=2, max_size=8), st.sampled_from(["day", "scan_"]))
def test_ten_comes_after_nine(numbers, stem):
    names = [f"{stem}{number}.txt" for number in numbers]
    order = [scan.name for scan in schedule(*names).scans]
    assert order == [f"{stem}{number}.txt" for number in sorted(numbers)]


def test_dates_are_written_for_people():
    dates = [scan.date for scan in schedule("2020-03-08.ply", "2020-03-09T14-30.ply").scans]
    assert dates == ["2020-03-08", "2020-03-09 14:30"]
    assert [scan.date for scan in schedule("day05.ply", "day7.5.ply").scans] == [
        "day 5",
        "day 7.5",
    ]
    assert [scan.date for scan in schedule("a.ply", "b.ply").scans] == ["0", "1"]


def test_a_rule_must_fit_every_scan():
    found = schedule("p_1.ply", "p_2020-03-08.ply")
    assert found.unit == "scans"
    assert "no time in the name 'p_1.ply'" in found.findings[0].sentence


def test_two_scans_at_one_time():
    for names in (["day5.ply", "day05.txt"], ["2020-03-08_a.ply", "2020-03-08_b.ply"]):
        with pytest.raises(InputError) as caught:
            schedule(*names)
        assert all(name in str(caught.value) for name in names)


def test_files_in_order():
    given_order = ["seedling.ply", "young.ply", "adult.ply"]
    found = schedule(*given_order, from_folder=False)
    assert [scan.name for scan in found.scans] == given_order
    assert "the order given" in found.findings[0].sentence

    found = schedule("day2.ply", "day1.ply", from_folder=False)
    assert [scan.name for scan in found.scans] == ["day1.ply", "day2.ply"]
    assert "not in the order given" in found.findings[0].sentence


def test_order_of_a_shell_pattern_is_put_right():
    names = ["s1.ply", "s10.ply", "s9.ply"]
    found = schedule(*names, from_folder=False)
    assert [scan.name for scan in found.scans] == sorted(names, key=natural_key)


def test_numbers_that_contradict_each_other():
    with pytest.raises(InputError, match="can't be told from their names"):
        schedule("a8_3.ply", "a10_3.ply", "a11_2.ply")


@pytest.mark.parametrize(
    "lines",
    [
        "a.ply 3\nb.ply 1.5\n",
        "a,3\nb,1.5\n",
        "# when\nscan;day\na.ply; 3\n\nb.ply; 1.5\n",
        "a.ply\t2020-03-08T12:00\nb.ply\t2020-03-07\n",
        "a.ply, 2020-03-08 12:00\nb.ply, 2020-03-07\n",
        "'a.ply' 3\n\"b.ply\" 1.5\nc.ply 7\n",
    ],
)
def test_times_file(tmp_path, lines):
    path = tmp_path / "times.csv"
    path.write_text(lines)
    found = schedule("a.ply", "b.ply", times_file=path)
    assert [scan.name for scan in found.scans] == ["b.ply", "a.ply"]
    assert gaps("a.ply", "b.ply", times_file=path) == [0, 1.5]
    assert "'times.csv'" in found.findings[0].sentence
    assert found.unit == "days"


def test_times_file_may_hold_dates_as_people_write_them(tmp_path):
    path = tmp_path / "times.csv"
    path.write_text("name;date\na.ply;27.02.2023\nb.ply;01.03.2023\n")
    assert gaps("a.ply", "b.ply", times_file=path) == [0, 2]


def test_times_file_comes_before_names(tmp_path):
    path = tmp_path / "times.txt"
    path.write_text("day1.ply 20\nday2.ply 10\n")
    assert times("day1.ply", "day2.ply", times_file=path) == [10, 20]


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        ("a.ply 1\n", r"no line for the scan 'b\.ply'"),
        ("a.ply 1\nb.ply 1\n", r"'a\.ply' and 'b\.ply' have the same time, day 1"),
        ("a.ply 1\nb.ply soon\n", r"line 2: 'soon' is no time; a number"),
        ("a.ply 1\nb.ply\n", r"line 2: expected"),
        ("a.ply 1\nb.ply 2020-02-30\n", r"line 2: '2020-02-30' is no time"),
        ("a.ply 1\nb.ply nan\n", r"line 2: 'nan' is no time"),
        ("a.ply 1\nb.ply 2020-02-20\n", r"mixes dates and numbers"),
        ("a.ply 1\na.ply 2\n", r"line 2: 'a\.ply' has a time already"),
        ("", r"no line for the scan 'a\.ply'"),
        (b"\xff\xfe\x00", r"is not a text file"),
    ],
)
def test_faults_in_a_times_file(tmp_path, lines, fault):
    path = tmp_path / "times.txt"
    path.write_bytes(lines if isinstance(lines, bytes) else lines.encode())
    with pytest.raises(InputError, match=fault):
        schedule("a.ply", "b.ply", times_file=path)


def test_times_file_not_there(tmp_path):
    with pytest.raises(InputError, match=r"absent\.txt' can't be read: No such file"):
        schedule("a.ply", "b.ply", times_file=tmp_path / "absent.txt")


def names_in(folder, times_file=None):
    return [path.name for path in find_scans([folder], times_file)]


def test_folder_passes_over_what_is_no_scan(make_folder):
    folder = make_folder(
        dict.fromkeys(
            [
                "day2.txt",
                "day10.txt",
                ".day3.txt",
                "README.txt",
                "LICENSE",
                "traits.csv",
                "a.json",
                "sub/day1.txt",
            ],
            "0 0 0",
        )
    )
    assert names_in(folder) == ["day2.txt", "day10.txt"]


@pytest.mark.parametrize(
    "names",
    [
        ["day1.ply", "day2.txt"],
        ["day1.ply", "day2.ply", "reference.ply"],
        ["plant1_day1.ply", "plant1_day3.ply", "plant2_day2.ply"],
        ["maize_day1.ply", "tomato_day2.ply"],
        ["M01_0313.ply", "M01_0314_b.ply", "M01_0315_a.ply"],
    ],
)
def test_two_series_in_a_folder(make_folder, names):
    folder = make_folder(dict.fromkeys(names, "0 0 0"))
    with pytest.raises(InputError, match="more than one series") as caught:
        names_in(folder)
    assert sum(name in str(caught.value) for name in names) == 2


@pytest.mark.parametrize(
    "names",
    [
        ["seedling.ply", "young.ply", "adult.ply"],
        ["scan1_2020-03-08.ply", "scan2_2020-03-10.ply"],
        ["2020-03-08.ply", "2020-03-09T12-00.ply"],
        ["s1.LAS", "s2.las"],
        ["M01_0313_a.ply", "M01_0314.ply", "M01_0315_a.ply"],
        ["1_maize_D00.txt", "2_maize_D01.txt", "10_maize_D09.txt"],
        ["p_27Feb2023.ply", "p_01Mar2023.ply", "p_05Mar2023.ply"],
    ],
)
def test_one_series_in_a_folder(make_folder, names):
    assert set(names_in(make_folder(dict.fromkeys(names, "")))) == set(names)


def test_times_file_says_what_belongs_together(make_folder):
    folder = make_folder({"day1.ply": "", "day2.ply": "", "last.ply": "", "times.txt": ""})
    assert len(names_in(folder, folder / "times.txt")) == 3


def test_folders_without_a_series(make_folder, tmp_path):
    with pytest.raises(InputError, match=r"holds no scans \(known are \.ply, .*\)"):
        names_in(make_folder({"notes": ""}, "none"))
    parts = dict.fromkeys(("a.sldprt", "b.SLDPRT", "c.step", "d.sldprt", "README.txt"), "")
    said = r"\.sldprt, \.step can't be read: export .* meshes as PLY, OBJ"
    with pytest.raises(InputError, match=rf"holds no scans; {said}"):
        names_in(make_folder(parts, "parts"))
    with pytest.raises(InputError, match=rf"at least two; {said}"):
        names_in(make_folder(parts | {"day1.ply": ""}, "parts"))
    with pytest.raises(
        InputError, match=r"no scans .* several folders, .* bake .*/below/\*/\*\.ply"
    ):
        names_in(make_folder({"sub/day1.ply": ""}, "below"))
    with pytest.raises(InputError, match=r"only one scan, 'day1\.ply'.* bake .*/\*/day1\.ply"):
        names_in(make_folder({"day1.ply": ""}, "one"))
    with pytest.raises(InputError, match="No such file or directory"):
        names_in(tmp_path / "absent")


def test_lists_that_are_no_series(make_folder):
    folder = make_folder({"a.ply": "", "b.ply": "", "c.step": "", "d.ply/e": ""})
    a, b = folder / "a.ply", folder / "b.ply"
    for inputs, fault in (
        ([], "No scans given"),
        ([a], "only one scan"),
        ([a, folder], "is a folder"),
        ([a, folder / "d.ply"], r"d\.ply' is a folder"),
        ([a, folder / "c.step"], r"unknown suffix '\.step'"),
        ([a, folder / "x.ply"], "No such file"),
        ([a, b, folder / "." / "a.ply"], "given twice"),
    ):
        with pytest.raises(InputError, match=fault):
            find_scans(inputs)


def test_a_time_of_millions_of_digits_is_refused_at_once(tmp_path):
    """In time that grows with the file: patterns would try every way to part such a number."""
    path = tmp_path / "times.txt"
    path.write_text("a.ply, 0\nb.ply, " + "1" * 3_000_000 + "x\n")
    with pytest.raises(InputError, match="line 2"):
        schedule("a.ply", "b.ply", times_file=path)


@pytest.mark.parametrize(
    ("first", "second", "said"),
    [
        ("day0.ply", f"day{'9' * 200}.ply", "days from"),
        ("day0.ply", f"day{'9' * 400}.ply", "days from"),
        ("day0.ply", f"day0.{'0' * 20}1.ply", "nearly the same time"),
    ],
)
def test_days_that_no_clip_could_hold_are_refused_by_name(first, second, said):
    with pytest.raises(InputError, match=rf"'{second}' ha.*{said}"):
        schedule(first, second)
    assert gaps("day0.ply", "day0.000001.ply", "day100000000.ply") == [0, 1e-6, 1e8]


def test_a_list_of_times_is_a_file_of_decent_size(tmp_path):
    path = tmp_path / "times.txt"
    with path.open("wb") as file:
        file.truncate(1 << 30)
    for listed, said in ((path, "holds 1,073,741,824 bytes"), (Path("/dev/zero"), "not a regular")):
        with pytest.raises(InputError, match=said):
            schedule("a.ply", "b.ply", times_file=listed)
