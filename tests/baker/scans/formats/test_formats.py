"""What is written in any format is read back; what isn't sound is refused with one sentence."""

import gzip
import os
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from baker.errors import InputError
from baker.scans.fields import choose_fields
from baker.scans.formats import READERS, read_columns
from baker.scans.labels import choose_labels
from tests.baker.sound_files import SOUND, lzf_literals


def read(path: Path, **options):
    cloud = choose_fields(read_columns(path), path, **options)
    return choose_labels([cloud], is_requested=True)[0][0]


def read_or_fault(path: Path, **options):
    try:
        return read(path, **options), ""
    except InputError as error:
        return None, str(error)


@pytest.mark.parametrize("offset", [(0, 0, 0), (364_000, 5_620_000, 60)])
def test_round_trip(any_format, make_sample, tmp_path, offset):
    suffix, write = any_format
    sample = make_sample(offset=offset)
    write(tmp_path / f"scan{suffix}", sample)

    cloud = read(tmp_path / f"scan{suffix}")

    # 1e-6 of 5,620,000 needs float64 all the way (open3d writes 10 digits in ascii).
    tolerance = 1e-3 if cloud.points.max() > 1e6 and suffix == ".pcd" else 1e-6
    np.testing.assert_allclose(cloud.points, sample.points, rtol=0, atol=tolerance)
    np.testing.assert_array_equal(cloud.labels, sample.labels)
    np.testing.assert_array_equal(cloud.colors, sample.colors)
    assert cloud.labels.dtype == np.int64
    assert cloud.colors.dtype == np.uint8


def test_float32_files_lose_nothing(tmp_path, make_sample, any_format):
    """Of LAS, which holds scaled integers, no more than half a step."""
    suffix, write = any_format
    sample = make_sample(dtype=np.float32, colors=False)
    write(tmp_path / f"scan{suffix}", sample)
    points = read(tmp_path / f"scan{suffix}").points
    if suffix in (".las", ".laz"):
        np.testing.assert_allclose(points, sample.points, rtol=0, atol=0.51e-4)
    elif suffix == ".pcd":
        np.testing.assert_allclose(points, sample.points, rtol=1e-7)
    else:
        np.testing.assert_array_equal(points.astype(np.float32), sample.points)


def test_positions_alone(any_format, make_sample, tmp_path):
    suffix, write = any_format
    write(tmp_path / f"scan{suffix}", make_sample(labels=False, colors=False))
    cloud = read(tmp_path / f"scan{suffix}")
    if suffix not in (".las", ".laz"):
        assert cloud.labels is None
    assert cloud.colors is None


def test_fields_used_are_noted(any_format, make_sample, tmp_path):
    suffix, write = any_format
    write(tmp_path / f"scan{suffix}", make_sample())
    note = read(tmp_path / f"scan{suffix}").notes[-1]
    assert note.startswith("positions from x, y, z; colours from red, green, blue (")


def test_truncated_anywhere_is_refused_or_shorter(any_format, make_sample, tmp_path, capfd):
    """A file cut at any byte raises InputError with its name, or is a text that ends cleanly."""
    suffix, write = any_format
    whole = tmp_path / f"whole{suffix}"
    sample = make_sample(20)
    write(whole, sample)
    content = whole.read_bytes()
    is_text = suffix in (".xyz", ".txt", ".csv", ".asc", ".pts")
    path = tmp_path / f"cut{suffix}"
    refused = 0
    for size in range(0, len(content) - 1, max(1, len(content) // 60)):
        path.write_bytes(content[:size])
        cloud, fault = read_or_fault(path)
        if cloud is None:
            assert f"cut{suffix}" in fault
            assert "\n" not in fault
            refused += 1
        else:
            # A ply may lose its faces, a text the end of its last number.
            assert is_text or len(cloud) == len(sample.points)
            np.testing.assert_allclose(
                cloud.points[:-1], sample.points[: len(cloud) - 1], atol=1e-6
            )
    assert refused > (5 if is_text else 30)
    assert capfd.readouterr() == ("", "")


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_damaged_anywhere_is_read_or_refused(any_format, make_sample, tmp_path, data):
    """Whatever bytes are overwritten: a cloud or an InputError, nothing else."""
    suffix, write = any_format
    whole = tmp_path / f"whole{suffix}"
    if not whole.exists():
        write(whole, make_sample(20))
    content = bytearray(whole.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, min(len(content), 600) - 1))
        junk = data.draw(st.binary(min_size=1, max_size=8))
        content[at : at + len(junk)] = junk
    path = tmp_path / f"damaged{suffix}"
    path.write_bytes(content)
    cloud, fault = read_or_fault(path, use_labels=data.draw(st.booleans()))
    if cloud is None:
        assert f"damaged{suffix}" in fault
    else:
        assert cloud.points.shape == (len(cloud), 3)


@pytest.mark.parametrize("suffix", READERS)
def test_garbage_and_empty_are_refused(tmp_path, suffix):
    path = tmp_path / f"scan{suffix}"
    path.write_bytes(b"")
    with pytest.raises(InputError, match=r"scan\.\w+' is an empty file"):
        read(path)
    for garbage in (os.urandom(5000), b"\xff" * 3000, b"hello world\n" * 30, b"\n" * 50):
        path.write_bytes(garbage)
        with pytest.raises(InputError, match=re.escape(str(path))):
            read(path)


@pytest.mark.parametrize("suffix", READERS)
def test_missing_and_folder_are_refused(tmp_path, suffix):
    with pytest.raises(InputError, match="No such file"):
        read(tmp_path / f"absent{suffix}")
    (tmp_path / f"folder{suffix}").mkdir()
    with pytest.raises(InputError, match="can't be read"):
        read(tmp_path / f"folder{suffix}")


def test_forbidden_file_is_one_sentence(tmp_path, monkeypatch):
    path = tmp_path / "scan.ply"
    path.write_text("ply\n")

    def refuse(*args, **kwargs):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(InputError, match=r"scan\.ply' can't be read: Permission denied\."):
        read(path)


def test_unknown_suffix_names_the_known_ones(tmp_path):
    (tmp_path / "scan.sldprt").write_text("v 0 0 0")
    with pytest.raises(InputError, match=r"unknown suffix '\.sldprt'; known are \.ply, .*\.laz"):
        read(tmp_path / "scan.sldprt")


def test_suffix_in_any_case(tmp_path):
    (tmp_path / "SCAN.XYZ").write_text("1 2 3\n")
    assert len(read(tmp_path / "SCAN.XYZ")) == 1


@pytest.mark.parametrize("last", ["", "\n"], ids=["no newline", "newline"])
def test_the_shortest_rows_there_can_be_have_room(tmp_path, last):
    """A header is believed as long as the file can hold what it says."""
    axes = "property float x\nproperty float y\nproperty float z\n"
    for count in (1, 3):
        rows = "\n".join(["1 2 3"] * count) + last
        header = f"ply\nformat ascii 1.0\nelement vertex {count}\n{axes}end_header\n"
        (tmp_path / "s.ply").write_text(header + rows)
        header = f"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS {count}\nDATA ascii\n"
        (tmp_path / "s.pcd").write_text(header + rows)
        for name in ("s.ply", "s.pcd"):
            columns = read_columns(tmp_path / name)
            assert [columns.values[axis].tolist() for axis in "xyz"] == [
                [1.0] * count, [2.0] * count, [3.0] * count
            ]  # fmt: skip


def test_a_gzipped_file_that_is_cut_short_or_none_is_refused(tmp_path):
    packed = gzip.compress(b"1 2 3\n4 5 6\n" * 50)
    for content in (packed[:-9], packed[:20], b"1 2 3\n", gzip.compress(b"")):
        (tmp_path / "a.xyz.gz").write_bytes(content)
        with pytest.raises(InputError, match=r"a\.xyz\.gz' (is not a valid gzip|is an empty file)"):
            read(tmp_path / "a.xyz.gz")


@pytest.mark.parametrize("suffix", [".npz", ".xyz.gz"])
def test_a_file_that_unpacks_to_far_more_than_a_scan_is_refused(tmp_path, suffix):
    path, count = tmp_path / f"a{suffix}", 4_000_000
    if suffix == ".npz":
        np.savez_compressed(path, points=np.zeros((count, 3)))
    else:
        path.write_bytes(gzip.compress(b"0 0 0 0 0 0 0 0 0 0 0 0\n" * count))
    with pytest.raises(InputError, match=r"unpacks to more than 100 times its size"):
        read_columns(path)


def test_a_line_of_a_gzipped_file_is_named(tmp_path):
    (tmp_path / "a.csv.gz").write_bytes(gzip.compress(b"1,2,3\n4,x,6\n"))
    with pytest.raises(InputError, match=r"a\.csv\.gz', line 2: 'x' is not a number"):
        read(tmp_path / "a.csv.gz")


def test_bytes_after_the_points_of_a_pcd_do_not_matter(tmp_path):
    header = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA binary\n"
    points = np.arange(6, dtype="<f4").reshape(2, 3)
    (tmp_path / "a.pcd").write_bytes(header.encode() + points.tobytes() + bytes(4000))
    assert read(tmp_path / "a.pcd").points.tolist() == points.tolist()


def test_fields_of_a_pcd_with_several_values_for_each_point_are_passed_over(tmp_path):
    """Compressed, fields lie one after the other, each with all values of the first point first."""
    header = "FIELDS x y z h\nSIZE 4 4 4 2\nTYPE F F F U\nCOUNT 1 1 1 2\nPOINTS 2\nDATA "
    record = np.dtype([*((axis, "<f4") for axis in "xyz"), ("h", "<u2", 2)])
    points = np.array([(1, 2, 3, (10, 11)), (4, 5, 6, (20, 21))], record)
    packed = lzf_literals(b"".join(points[name].tobytes() for name in record.names))
    sizes = np.array([len(packed), points.nbytes], "<u4").tobytes()
    for form, body in (
        ("ascii", b"1 2 3 10 11\n4 5 6 20 21\n"),
        ("binary", points.tobytes()),
        ("binary_compressed", sizes + packed),
    ):
        (tmp_path / "a.pcd").write_bytes(f"{header}{form}\n".encode() + body)
        columns = read_columns(tmp_path / "a.pcd").values
        assert {name: values.tolist() for name, values in columns.items()} == {
            "x": [1, 4], "y": [2, 5], "z": [3, 6]
        }  # fmt: skip


def test_faces_may_come_before_the_vertices_of_a_ply(tmp_path):
    header = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
    header += "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    (tmp_path / "a.ply").write_text(header + "3 0 0 0\n0 0 0\n1 0 0\n0 1 0\n")
    assert read(tmp_path / "a.ply").points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def test_bools_of_a_ply_are_bytes(tmp_path):
    header = "ply\nformat {} 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    header += "property float z\nproperty bool label\nend_header\n"
    rows = np.zeros(3, [("xyz", "<f4", 3), ("label", "u1")])
    rows["xyz"], rows["label"] = np.eye(3), [0, 1, 1]
    binary = header.format("binary_little_endian").encode() + rows.tobytes()
    (tmp_path / "a.ply").write_bytes(binary)
    (tmp_path / "b.ply").write_text(header.format("ascii") + "1 0 0 0\n0 1 0 1\n0 0 1 1\n")
    for name in ("a.ply", "b.ply"):
        cloud = read(tmp_path / name)
        assert cloud.points.tolist() == np.eye(3).tolist()
        assert cloud.labels.tolist() == [0, 1, 1]


@pytest.mark.parametrize(
    ("row", "fault"),
    [
        ("1 2 3 x", "cut short .*'x'"),
        ("1 2 3", "cut short|announces 8 values, but 7"),
        ("1 2 3 4 5", "requires 4 columns but 5|announces 8 values, but 9"),
    ],
)
def test_rows_of_texts_hold_what_their_headers_announce(tmp_path, row, fault):
    axes = "".join(f"property float {axis}\n" for axis in "xyz")
    ply = f"ply\nformat ascii 1.0\nelement vertex 2\n{axes}property uchar label\nend_header\n"
    pcd = "FIELDS x y z label\nSIZE 4 4 4 1\nTYPE F F F U\nPOINTS 2\nDATA ascii\n"
    for name, header in (("s.ply", ply), ("s.pcd", pcd)):
        (tmp_path / name).write_text(f"{header}0 0 0 0\n{row}\n")
        with pytest.raises(InputError, match=fault):
            read_columns(tmp_path / name)


def test_numbers_of_texts_are_not_cut_to_the_type_that_is_announced(tmp_path):
    """300 is no byte, nor is 1.5: they stay as they are written, or are refused."""
    ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty uchar label\nend_header\n"
    pcd = "FIELDS label\nSIZE 1\nTYPE U\nPOINTS 2\nDATA ascii\n"
    (tmp_path / "s.ply").write_text(f"{ply}300\n1.5\n")
    assert read_columns(tmp_path / "s.ply").values["label"].tolist() == [300, 1.5]
    for number in ("300", "1.5"):
        (tmp_path / "s.pcd").write_text(f"{pcd}1\n{number}\n")
        with pytest.raises(InputError, match=f"'{number}' to uint8"):
            read_columns(tmp_path / "s.pcd")


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_faces_of_a_ply_may_have_any_numbers_of_corners(tmp_path, form):
    """Of triangles, a square and a face without corners, the area counts."""
    order = ">" if "big" in form else "<"
    header = f"ply\nformat {form} 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
    header += "property float z\nelement face 4\nproperty uchar flag\n"
    header += "property list uchar int vertex_index\nend_header\n"
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [9, 0, 0], [9, 1, 0]])
    faces = [[0, 1, 2], [], [0, 1, 2, 3], [1, 4, 5]]
    if form == "ascii":
        rows = [*points.tolist(), *([7, len(face), *face] for face in faces)]
        body = "\n".join(" ".join(map(str, row)) for row in rows).encode()
    else:
        body = points.astype(f"{order}f4").tobytes() + b"".join(
            bytes([7, len(face)]) + np.array(face, f"{order}i4").tobytes() for face in faces
        )
    (tmp_path / "a.ply").write_bytes(header.encode() + body)
    cloud = read(tmp_path / "a.ply")
    assert "4 triangles:" in cloud.notes[0]
    assert (cloud.points[:, 0] > 1).mean() == pytest.approx(4 / 5.5, abs=0.01)


def test_a_las_of_scale_zero_is_refused(tmp_path):
    for kind in ("las 1.2", "laz 1.4"):
        name, make = SOUND[kind]
        content = make()
        (tmp_path / name).write_bytes(content[:131] + bytes(8) + content[139:])
        with pytest.raises(InputError, match="scale 0"):
            read(tmp_path / name)
