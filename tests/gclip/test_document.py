"""A document's text is read within bounds, or refused; what it says is printable."""

from __future__ import annotations

import json

import pytest

import gclip
from gclip.file import Container, decode_document
from gclip.text import printable
from tests.gclip.hostile import INJECTIONS, good_clips


def test_a_document_is_measured_before_it_is_read() -> None:
    text = good_clips()[0][0].rstrip("}") + '},"x":[' + "[]," * 450_000 + "0]}"
    with pytest.raises(gclip.ClipError, match="far more values"):
        decode_document(Container(text, {}, 1000), gclip.Clip)
    with pytest.raises(gclip.ClipError, match="its document"):
        decode_document(Container(text.replace('"up"', '"down"'), {}, 100_000_000), gclip.Clip)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"version":"1.0","a":NaN}', "not valid JSON: .*invalid character"),
        ('{"version":"1.0","a":-Infinity}', "not valid JSON: .*invalid character"),
        ('{"version":"1.0","a":1e999}', "number out of range"),
        ('{"version":"1.0","a":[[-1e999]]}', "number out of range"),
        ('{"version":"1.0","a":' + "9" * 5000 + "}", "integer value out of range"),
        ('{"version":"1.0","a":"\\ud800"}', "not valid JSON: "),
        ('{"version":"1.0","a":' + "[" * 33, "not valid JSON: .*truncated"),
        ('{"version":"1.0","a":' + "[" * 100_000, "not valid JSON: .*recursion"),
        ('{"a":' * 100_000, "not valid JSON: .*recursion"),
        ('{"version":', "not valid JSON: Input data was truncated"),
        ("", "not valid JSON: Input data was truncated"),
        ("[]", "its document: expected `object`, got `array`"),
        ("7", "its document: expected `object`, got `int`"),
        ("null", "its document: expected `object`, got `null`"),
        ("{}", "its document: object missing required field `version`"),
    ],
)
def test_what_is_no_document_is_named(text: str, words: str) -> None:
    with pytest.raises(gclip.ClipError, match=words):
        decode_document(Container(text, {}, 1 << 20), gclip.Clip)


def test_text_gives_no_orders() -> None:
    for text in set(INJECTIONS) - {"\ud800"}:  # a lone surrogate is not valid JSON
        document = json.loads(good_clips()[0][0])
        document["unit"] = text[:1000]
        document["provenance"] = {text: [text, {"a": [[text]]}]}
        read = decode_document(Container(json.dumps(document), {}, 1 << 20), gclip.Clip)
        assert read.unit == printable(text[:1000])
        said = printable(text)
        assert read.provenance == {said: [said, {"a": [[said]]}]}


def test_a_refusal_is_short_and_printable() -> None:
    document = json.loads(good_clips()[0][0])
    document["up"] = "\x1b[2J" + "x" * 900
    with pytest.raises(gclip.ClipError) as refusal:
        decode_document(Container(json.dumps(document), {}, 1 << 20), gclip.Clip)
    assert str(refusal.value).isprintable()
    assert len(str(refusal.value)) <= 300
