"""Read a clip's document from JSON, with limits and a schema, and write it.

Control characters in its texts are replaced.
"""

import hashlib
import json
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import Annotated, Any

import msgspec
from msgspec import DecodeError, Meta, Struct, ValidationError

from gclip.errors import ClipError
from gclip.schema import Document
from gclip.text import printable

MAJOR, MINOR = 1, 2  # of the format's version
SPARE_MEMORY = 64 << 20  # bytes that the values may occupy beyond twice the size of the file
MAX_DEPTH = 32  # of nested objects and lists
DOCUMENT, BLANK = "document", "0" * 64  # the document's checksum is taken with this in its place


class Versioned(Struct):
    """The part that documents of all versions have in common."""

    version: Annotated[str, Meta(max_length=1000, pattern=r"^[0-9]+(\.|$)")]


def read_document(text: str, file_size: int) -> Document:
    """Parse and check a clip's document.

    file_size: in bytes; it limits the memory that the values may occupy. Raises ClipError, which
    names the wrong field, in a sentence without a full stop.
    """
    # An upper bound of the memory that the values occupy, with those of the data model: it was
    # measured how many bytes each object, list, entry and name takes at most.
    values = {"{": 300, "[": 80, ",": 88, ":": 210}
    memory = 3 * sys.getsizeof(text) + sum(text.count(c) * size for c, size in values.items())
    if memory > SPARE_MEMORY + 2 * file_size:
        raise ClipError("its document holds far more values than a file of its size needs")
    try:
        major = msgspec.json.decode(text, type=Versioned).version.split(".")[0]
        if int(major) > MAJOR:
            raise ClipError(
                f"it was written in clip format {major[:20]}; this program reads up to "
                f"{MAJOR}.{MINOR}, so a newer version of it is needed"
            )
        content = _cleaned(msgspec.json.decode(text))
        with suppress(LookupError, TypeError):  # `convert` says what is wrong with the tracks
            for index, track in enumerate(content["tracks"]):
                track["id"] = index
        return msgspec.convert(content, Document)
    except ValidationError as error:  # in the form "reason - at `$.field`"
        reason, _, field = str(error).partition(" - at `$")
        location = f", at {field.strip('.`')}" if field else ""
        sentence = f"its document{location}: {reason[:1].lower()}{reason[1:]}"
    except (DecodeError, RecursionError) as error:
        sentence = f"its document is not valid JSON: {error}"
    raise ClipError(printable(sentence, 300))


def _cleaned(value: Any, levels: int = MAX_DEPTH) -> Any:
    """A JSON value, nested at most `levels` deep, with control characters replaced."""
    if isinstance(value, str):
        return printable(value)
    if not isinstance(value, dict | list):
        return value
    if not levels:
        raise ClipError(f"its document is nested more than {MAX_DEPTH} levels deep")
    if isinstance(value, dict):
        return {printable(name): _cleaned(each, levels - 1) for name, each in value.items()}
    return [_cleaned(each, levels - 1) for each in value]


def write_document(content: Mapping[str, Any], buffers: Mapping[str, Any]) -> str:
    """Write a document as JSON; equal content gives equal bytes.

    buffers: arrays in C order by name; their checksums, the document's own and the version are
    added.
    """
    fields = msgspec.to_builtins(content, enc_hook=lambda number: number.item())  # NumPy scalars
    fields["version"] = f"{MAJOR}.{MINOR}"
    fields["sha256"] = {name: checksum(b) for name, b in buffers.items()} | {DOCUMENT: BLANK}
    text = json.dumps(
        fields, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
    )
    text = printable(text)  # the name of a file may not be valid UTF-8
    own = f'"{DOCUMENT}":"{BLANK}"'
    return text.replace(own, own.replace(BLANK, checksum(text.encode())))


def checksum(content: Any) -> str:
    """SHA-256 of bytes, or of an array in C order, as hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()
