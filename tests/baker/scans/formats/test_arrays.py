"""NPY and NPZ: which arrays are points, colours and labels, and what is refused."""

import re

import numpy as np
import pytest

from baker.errors import InputError
from baker.scans.fields import choose_fields
from baker.scans.formats import read_columns
from baker.scans.labels import choose_labels

POINTS = np.arange(12.0).reshape(4, 3)


def read(path, **options):
    cloud = choose_fields(read_columns(path), path, **options)
    return choose_labels([cloud], is_requested=True)[0][0]


@pytest.mark.parametrize("name", ["points", "positions", "xyz"])
def test_names_of_the_points(tmp_path, name):
    np.savez_compressed(tmp_path / "a.npz", **{name: POINTS.astype(np.float32)})
    assert read(tmp_path / "a.npz").points.tolist() == POINTS.tolist()


def test_colors_and_labels(tmp_path):
    colors = np.linspace(0, 1, 16, dtype=np.float32).reshape(4, 4)
    np.savez(tmp_path / "a.npz", points=POINTS, colors=colors, labels=[0, -1, 2, 3], organ=range(4))
    cloud = read(tmp_path / "a.npz")
    assert cloud.labels.tolist() == [0, 1, 2, 3]  # that of organs
    np.testing.assert_array_equal(cloud.colors, np.rint(colors[:, :3] * 255))
    assert read(tmp_path / "a.npz", label_field="label").labels.tolist() == [0, -1, 2, 3]


def test_columns_of_a_table(tmp_path):
    np.save(tmp_path / "a.npy", np.hstack([POINTS, [[5], [5], [6], [6]]]))
    cloud = read(tmp_path / "a.npy")
    assert cloud.labels.tolist() == [5, 5, 6, 6]
    assert "columns taken as x y z column 4" in cloud.notes[0]


@pytest.mark.parametrize(
    ("arrays", "fault"),
    [
        ({"vertices": POINTS}, "has no array 'points' (it has vertices)"),
        ({"points": POINTS.T}, "'points' of shape (3, 4) and type float64, not (N, 3)"),
        ({"points": POINTS, "labels": [1, 2]}, "has 4 points, but 2 values in its array 'label'"),
        ({"points": np.array([{}, {}])}, "Object arrays cannot be loaded"),
        (
            {"points": np.array([["a"] * 3])},
            "'points' of shape (1, 3) and type <U1, not (N, 3) numbers",
        ),
    ],
)
def test_other_arrays_are_refused(tmp_path, arrays, fault):
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(InputError, match=re.escape(fault)):
        read(tmp_path / "a.npz")


def test_a_shape_that_lies_makes_no_room(tmp_path):
    for name, save in (("a.npy", np.save), ("a.npz", np.savez)):
        save(tmp_path / name, POINTS)
        lying = (tmp_path / name).read_bytes().replace(b"(4, 3), } ", b"(10**15, 3)")
        lying = lying.replace(b"'shape': (4, 3), }     ", b"'shape': (40000000, 3)}")
        (tmp_path / name).write_bytes(lying)
        with pytest.raises(InputError, match=re.escape(name)):
            read(tmp_path / name)
