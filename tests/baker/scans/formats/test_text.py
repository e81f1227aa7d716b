"""Text tables: delimiters, headers, layouts by the number of columns, faults by line."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from baker.errors import InputError
from baker.scans.fields import choose_fields
from baker.scans.formats import read_columns
from baker.scans.labels import choose_labels


@pytest.fixture
def load(tmp_path):
    def load(content: str | bytes, name: str = "scan.txt", names=(), is_asked=True, **options):
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        cloud = choose_fields(read_columns(path, names), path, **options)
        return choose_labels([cloud], is_asked)[0][0]

    return load


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    rows=st.lists(
        st.tuples(*[st.floats(-1e9, 1e9)] * 3, st.integers(-(2**40), 2**40)), min_size=1, max_size=8
    ),
    order=st.permutations(["x", "y", "z", "label"]),
    delimiter=st.sampled_from([" ", "   ", ",", ", ", ";", "\t"]),
    prefix=st.sampled_from(["", "#", "# ", "//"]),
    upper=st.booleans(),
    newline=st.sampled_from(["\n", "\r\n"]),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]),
)
def test_any_dialect_with_header(load, rows, order, delimiter, prefix, upper, newline, encoding):
    named = [dict(zip(["x", "y", "z", "label"], row, strict=True)) for row in rows]
    header = prefix + delimiter.join(order)
    lines = [header.upper() if upper else header]
    lines += [delimiter.join(repr(row[name]) for name in order) for row in named]

    cloud = load((newline.join(lines) + newline).encode(encoding))

    assert cloud.points.tolist() == [list(row[:3]) for row in rows]
    assert cloud.labels.tolist() == [row[3] for row in rows]


@pytest.mark.parametrize(
    ("row", "labels", "colors"),
    [
        ("1 2 3", None, None),
        ("1 2 3 -7", [-7], None),
        ("1 2 3 10 20 30", None, [[10, 20, 30]]),
        ("1 2 3 65535 0 32768", None, [[255, 0, 128]]),
        ("1 2 3 1 0 0.5", None, [[255, 0, 128]]),
        ("1 2 3 -0.6 0 0.8", None, None),
        ("1 2 3 10 20 30 4", [4], [[10, 20, 30]]),
        ("1 2 3 -0.6 0 0.8 4", [4], None),
    ],
)
def test_columns_without_header(load, row, labels, colors):
    cloud = load(f"{row}\n")
    assert cloud.points.tolist() == [[1, 2, 3]]
    assert (None if cloud.labels is None else cloud.labels.tolist()) == labels
    assert (None if cloud.colors is None else cloud.colors.tolist()) == colors
    assert "no header line: columns taken as x y z" in cloud.notes[0]


def test_labels_may_be_in_the_fifth_column(load):
    assert load("1 2 3 7 0.25\n9 8 7 5 0.5\n", is_asked=False).labels.tolist() == [7, 5]
    assert load("1 2 3 0.25 7\n9 8 7 0.5 5\n", is_asked=False).labels.tolist() == [7, 5]


def test_point_count_before_rows_is_leicas_format(load):
    cloud = load("2\n1 2 3 -1200 10 20 30\n4 5 6 -1100 40 50 60\n", "scan.pts", is_asked=False)
    assert cloud.points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert cloud.colors.tolist() == [[10, 20, 30], [40, 50, 60]]
    assert cloud.labels is None
    with pytest.raises(InputError, match=r"announces 3 rows, but 2 follow"):
        load("3\n1 2 3\n4 5 6\n", "scan.pts")


def test_cloudcompare_header(load):
    cloud = load("//X Y Z R G B scalar_Label\n1\n1 2 3 10 20 30 5\n")
    assert cloud.labels.tolist() == [5]
    assert cloud.colors.tolist() == [[10, 20, 30]]


def test_words_are_labels_where_they_may_be(load):
    rows = "1,2,3,leaf10,hot\n4,5,6,stem,cold\n7,8,9,leaf9,hot\n"
    cloud = load("x,y,z,organ,state\n" + rows, "scan.csv")
    assert cloud.labels.tolist() == [1, 2, 0]  # leaf9, leaf10, stem
    assert cloud.notes[0] == "columns passed over, as they hold no numbers: state."
    with pytest.raises(InputError, match=r"no field 'state'; the fields found: x, y, z, organ"):
        load("x,y,z,organ,state\n" + rows, "scan.csv", label_field="state")
    assert load("1 2 3 stem\n4 5 6 leaf1\n").labels.tolist() == [1, 0]
    assert load("1 2 3 9 9 9 stem\n4 5 6 8 8 8 leaf1\n").colors.tolist() == [[9] * 3, [8] * 3]


def test_columns_are_what_the_user_says(load):
    text = "1 2 3 10 20 30 1 7\n4 5 6 40 50 60 1 8\n"
    cloud = load(text, names=["x", "y", "z", "r", "g", "b", "-", "label"])
    assert cloud.labels.tolist() == [7, 8]
    assert cloud.colors.tolist() == [[10, 20, 30], [40, 50, 60]]
    cloud = load("a b c\nleaf 1 2 3\n", names=["_", "z", "y", "x"])
    assert cloud.points.tolist() == [[3, 2, 1]]
    with pytest.raises(InputError, match=r"8 columns, but 4 names of columns \(x y z label\)"):
        load(text, names=["x", "y", "z", "label"])


def test_comments_and_blank_lines_between_rows(load):
    assert len(load("\n# made by hand\n1 2 3\n\n4 5 6 # the tip\n# end\n")) == 2


def test_trailing_delimiters(load):
    assert load("1;2;3;\n4;5;6;\n").points.tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize(
    ("row", "names"),
    [
        ("9 8 7 1 2", "red green blue column_7 column_8"),
        ("9 8 7 leaf 2", "red green blue column_7 column_8"),
        ("9 8 7 0 -.6 .8", "red green blue nx ny nz"),
        ("0 -.6 .8 9 8 7 2", "nx ny nz red green blue column_10"),
        ("9 8 7 6 5 4", "red green blue column_7 column_8 column_9"),
        ("leaf 2", "column_4 column_5"),
    ],
)
def test_more_columns_without_a_header(tmp_path, row, names):
    path = tmp_path / "scan.txt"
    path.write_text(f"1 2 3 {row}\n4 5 6 {row}\n")
    found = sorted(name.replace(" ", "_") for name in read_columns(path).values)
    assert found == sorted(["x", "y", "z", *names.split()])


def test_decimal_commas_between_semicolons(load):
    assert load("X;Y;Z\n1;2;3\n1,5;-2,25;3\n").points.tolist() == [[1, 2, 3], [1.5, -2.25, 3]]
    assert load("1;2;3,5\n").points.tolist() == [[1, 2, 3.5]]
    assert load("1;2;3\n" * 2000 + "4;5;6,5\n").points[-1].tolist() == [4, 5, 6.5]


def test_quoted_values(load):
    assert load('"x","y","z"\n"1","2","3"\n').points.tolist() == [[1, 2, 3]]


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        ("1 2 3\n4 5\n", r"line 2: 2 values found, but 3 expected"),
        ("1 2 3\n4 5 6 7\n", r"line 2: 4 values found, but 3 expected"),
        ("# c\n\n1 2 3 4\n1 2 x 4\n", r"line 4: 'x' is not a number"),
        ("1 2 3 4\n1 2 abc\n", r"line 2: 3 values found, but 4 expected"),
        ("x y z\n1 2 3 4\n", r"line 2: 4 columns, but 3 names of columns"),
        ("x y z label\n1 2 3 4\n1 2 3\n", r"line 3: 3 values .* \(x y z label\)"),
        ("x y z x\n1 2 3 4\n", r"names two columns 'x'"),
        ("a b c\n1 2 3\n", r"no field 'x'; the fields found: a, b, c"),
        ("1 2\n3 4\n", r"no row of numbers: at least x, y and z"),
        (f"{'1 ' * 13}\n", r"line 1: 13 columns .* 3 to 12 are understood; .* --columns"),
        ("leaf 1 2 3\n", r"line 1: 'leaf' is not a number; .* --columns label,x,y,z"),
        ("1 2 three 4\n1 2 3 4\n", r"line 1: 'three' is not a number"),
        ("1,5\t2,5\t3,5\n", r"no row of numbers: at least x, y and z, with points in decimals"),
        ("1,5\t2,5\t3,5\t1\t2\t3\n", r"line 1: '1,5' is not a number; write decimals with a p"),
        ("1 2 3\n1,5 2,5 3,5\n", r"line 2: '1,5' is not a number; write decimals with a point"),
        ("x y z\n", r"holds no row of numbers"),
        ("# only words\n", r"holds no row of numbers"),
        ("1 2 3 4\n1 2 3 stem\n", r"line 2: 'stem' is not a number, but the first row has one"),
        ("lon lat h\n1 2 3\n", r"no field 'x'; the fields found: lon, lat, h"),
        ("".join(f"{k} 1 2 3\n" for k in range(20)), r"counts the rows; say what the columns are"),
        ("1 2 3 0.5\n", r"the field 'column 4' holds 0.5, but labels must be whole numbers"),
        ("1 2 3 1e30\n", r"the field 'column 4' holds 1e\+30"),
        ("x y label\n1 2 3\n", r"no field 'z'; the fields found: x, y, label"),
    ],
)
def test_faults_are_told_with_their_line(load, content, fault):
    with pytest.raises(InputError, match=fault) as caught:
        load(content)
    assert "scan.txt'" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_labels_can_be_left_unread(load):
    assert load("1 2 3 0.5\n", use_labels=False).labels is None


def test_a_million_values_are_read(load):
    rows = np.random.default_rng(0).random((250_000, 4))
    rows[:, 3] = 3
    content = "\n".join(f"{x:.4f} {y:.4f} {z:.4f} {n:.0f}" for x, y, z, n in rows.tolist())
    cloud = load(content)
    np.testing.assert_allclose(cloud.points, rows[:, :3].round(4), atol=1e-9)
    assert (cloud.labels == 3).all()


@pytest.mark.parametrize(
    "header", ["X (mm),Y (mm),Z (mm)", "x_coord,y_coord,z_coord", "PosX,PosY,PosZ"]
)
def test_axes_by_other_names(load, header):
    assert load(f"{header},label\n1,2,3,4\n").points.tolist() == [[1, 2, 3]]


def test_cells_between_tabs_may_hold_spaces(load):
    cloud = load("X (mm)\tY (mm)\tZ (mm)\torgan\n1\t2\t3\tleaf 2\n4\t5\t6\tstem\n")
    assert cloud.points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert cloud.labels.tolist() == [0, 1]
    assert load("1 2\t3\n4 5\t6\n").points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert load("1\t\t2\t\t3\n4\t5\t6\n").points.tolist() == [[1, 2, 3], [4, 5, 6]]


def test_scans_without_labels_have_fewer_columns_than_are_named(load):
    names = ("x", "y", "z", "r", "label")
    assert load("1 2 3 4\n", names=names).labels is None
    assert load("1 2 3 4 5\n", names=names).labels.tolist() == [5]
