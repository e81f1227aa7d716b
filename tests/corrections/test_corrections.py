"""The file of corrections: written, read back, and refused in one sentence where it makes none."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from corrections import Correction, Place, read_corrections, write_corrections
from gclip import UserError

TEXT = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
NUMBER = st.floats(-1e6, 1e6).map(lambda number: float(f"{number:.9g}"))
PLACE = st.builds(Place, TEXT, st.tuples(NUMBER, NUMBER, NUMBER), TEXT)
CORRECTION = st.one_of(
    st.builds(Correction, st.sampled_from(["same", "different"]), st.tuples(PLACE, PLACE)),
    st.builds(Correction, st.just("cut"), st.tuples(PLACE)),
    st.builds(Correction, st.just("name"), st.tuples(PLACE), TEXT.filter(bool)),
)
SOUND = '[[correction]]\nkind = "cut"\nplaces = [{ scan = "a.ply", point = [1, 2.5, 3] }]\n'


@given(corrections=st.lists(CORRECTION, max_size=4))
def test_what_is_written_is_read(corrections, tmp_path_factory):
    path = tmp_path_factory.mktemp("written") / "plant.corrections.toml"
    write_corrections(path, corrections)
    assert read_corrections(path) == tuple(corrections)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"cut"', '"trim"', "correction 1.kind is 'trim'; "),
        ("2.5", '"high"', "correction 1.places 1.point 2 is 'high'; "),
        ("2.5", "nan", "correction 1.places 1.point 2 is nan; "),
        (", 3]", "]", "correction 1.places 1.point is [1, 2.5]; "),
        ("point", "pont", "pont"),
        ('"cut"', '"same"', "same needs 2 places"),
        ('"cut"', '"name"', "name is needed"),
        ("correction", "korrection", "korrection"),
        ("[[", "[", "is not valid TOML"),
        ("a.ply", "a\x00", "is not valid TOML"),
        ("kind", "'a - at `$.correction[9].b'", "unknown field `a"),
    ],
)
def test_what_makes_no_sense_is_said_in_one_sentence(old, new, said, tmp_path):
    path = tmp_path / "plant.corrections.toml"
    path.write_text(SOUND)
    assert read_corrections(path)[0].places[0].point == (1.0, 2.5, 3.0)
    path.write_text(SOUND.replace(old, new))
    with pytest.raises(UserError, match=path.name) as caught:
        read_corrections(path)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "plant.corrections.toml")
    with pytest.raises(UserError, match="not a regular file"):
        read_corrections(tmp_path / "plant.corrections.toml")


def test_a_file_that_is_not_there_is_named():
    with pytest.raises(UserError, match=r"nowhere\.toml' can't be read: No such file"):
        read_corrections(Path("nowhere.toml"))
