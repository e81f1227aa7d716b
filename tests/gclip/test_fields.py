"""Fields of a document: read within bounds, or refused by their name."""

from __future__ import annotations

import pytest

import gclip
from gclip.fields import SPARE, Fields, footprint, parse
from gclip.text import printable
from tests.gclip.hostile import INJECTIONS, NUMBERS


def test_a_document_is_measured_before_it_is_read() -> None:
    text = '{"a":[' + "[]," * 450_000 + "0]}"
    with pytest.raises(gclip.ClipError, match="far more values"):
        parse(text, 1000)
    assert parse(text, footprint(text)).items("a")[0] == []
    edge = (footprint(text) - SPARE + 1) // 2
    with pytest.raises(gclip.ClipError, match="far more values"):
        parse(text, edge - 1)
    parse(text, edge)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"a":1,"a":1}', "the same field twice"),
        ('{"a":NaN}', "holds NaN"),
        ('{"a":-Infinity}', "holds -Infinity"),
        ('{"a":1e999}', "more than a number can be"),
        ('{"a":-1e999}', "more than a number can be"),
        ('{"a":' + "9" * 5000 + "}", "too many digits"),
        ("[" * 100_000, "nested too deeply"),
        ('{"a":' * 100_000, "nested too deeply"),
        ("[1,", "at character 3"),
        ("", "at character 0"),
        ("7", "its document is not an object"),
        ("null", "its document is not an object"),
    ],
)
def test_what_is_no_document_is_named(text: str, words: str) -> None:
    with pytest.raises(gclip.ClipError, match=words):
        parse(text, 1 << 20)


@pytest.mark.parametrize("value", [v for v in NUMBERS if not isinstance(v, bool)])
def test_numbers_are_within_bounds_or_refused(value: float) -> None:
    fields = Fields({"x": value, "v": [value, 0, 0]})
    if -1e18 <= value <= 1e18:
        assert fields.number("x") == float(value)
        assert fields.vector("v") == (float(value), 0, 0)
    else:
        for read in (fields.number, fields.optional_number):
            with pytest.raises(gclip.ClipError, match=r"x is .*; a number up to 1e\+18 is needed"):
                read("x")
        with pytest.raises(gclip.ClipError, match="v is a list; three times a number"):
            fields.vector("v")
    if isinstance(value, int) and 0 <= value < 2**48:
        assert fields.count("x") == fields.optional_count("x") == value
    else:
        with pytest.raises(gclip.ClipError, match="a whole number from 0 is needed"):
            fields.count("x")


@pytest.mark.parametrize("wrong", [True, None, "1", [], {}, [1]])
def test_what_is_no_number_is_refused(wrong: object) -> None:
    for read in (Fields({"x": wrong}).number, Fields({"x": wrong}).count):
        with pytest.raises(gclip.ClipError, match="x is"):
            read("x")


def test_a_number_below_the_least_is_refused() -> None:
    assert Fields({"x": 2}).number("x", lowest=2.0) == 2.0
    with pytest.raises(gclip.ClipError, match=r"x is 1\.9; at least 2 is needed"):
        Fields({"x": 1.9}).number("x", lowest=2.0)


@pytest.mark.parametrize("length", [2, 4])
def test_vectors_have_three_numbers(length: int) -> None:
    with pytest.raises(gclip.ClipError, match="three"):
        Fields({"v": [0.0] * length}).vector("v")


def test_text_is_of_bounded_length_and_gives_no_orders() -> None:
    assert Fields({"x": "a" * 1000}).text("x") == "a" * 1000
    with pytest.raises(gclip.ClipError, match="1001 characters long; 1000 are allowed"):
        Fields({"x": "a" * 1001}).text("x")
    for text in INJECTIONS:
        read = Fields({"x": text[:1000], "l": [text, "b"], "o": {text: [text]}})
        assert read.text("x") == printable(text[:1000])
        assert read.texts("l")[0] == printable(text, 1000)
        assert read.anything("o") == {printable(text): [printable(text)]}
    with pytest.raises(gclip.ClipError, match="l holds something else than text"):
        Fields({"l": ["a", 1]}).texts("l")


def test_printable_shows_what_people_write_and_nothing_else() -> None:
    joined = "می\N{ZERO WIDTH NON-JOINER}روم"
    spaced = ("葉\N{IDEOGRAPHIC SPACE}1", "a\N{NO-BREAK SPACE}b")
    for plain in ("", "leaf 3", "Blatt №5 – größer", "🌱", joined, *spaced):
        assert printable(plain) == plain
    assert printable("a\x1b[2Jb\nc\u202ed\ud800e\u2028") == "a\ufffd[2Jb\ufffdc\ufffdd\ufffde\ufffd"
    assert printable("abcdef", 4) == "abc…"
    assert printable("abcd", 4) == "abcd"


def test_provenance_is_of_bounded_depth() -> None:
    def nested(levels: int) -> dict:
        value: object = 1
        for _ in range(levels):
            value = [value]
        return {"p": {"deep": value}}

    assert Fields(nested(31)).anything("p")
    with pytest.raises(gclip.ClipError, match="p is nested more than 32 levels deep"):
        Fields(nested(32)).anything("p")
    assert Fields({}).anything("p") == {}
