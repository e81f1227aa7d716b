"""A clip's document as JSON text: read within bounds and checked by its schema, and written.

Text comes without control characters.
"""

import hashlib
import json
import math
import sys
from collections.abc import Mapping
from typing import Annotated, Any

from msgspec import Meta, Struct, ValidationError, convert, to_builtins

from gclip.errors import ClipError
from gclip.schema import Document
from gclip.text import printable

MAJOR, MINOR = 1, 2  # of the format's version
SPARE_MEMORY = 64 << 20  # bytes that the values may take up beyond twice the file's size
DOCUMENT, BLANK = "document", "0" * 64


class Versioned(Struct):  # what documents of every version have in common
    version: Annotated[str, Meta(max_length=1000, pattern=r"^[0-9]+(\.|$)")]


def read_document(text: str, file_size: int) -> Document:
    """What a clip's document says, all of it checked.

    The bytes of the file bound the memory that the values may take up. Raises ClipError with one
    sentence, without a full stop, that names the field and what is wrong with it.
    """
    if footprint(text) > SPARE_MEMORY + 2 * file_size:
        raise ClipError("its document holds far more values than a file of its size needs")
    try:
        found = json.loads(text, object_pairs_hook=_object)
        major = convert(found, Versioned).version.split(".")[0]
        if int(major) > MAJOR:
            raise ClipError(
                f"it was written in clip format {major[:20]}; this program reads up to "
                f"{MAJOR}.{MINOR}, so a newer version of it is needed"
            )
        return convert(found, Document)
    except ValidationError as error:  # in the form "reason - at `$.field`"
        reason, _, field = str(error).partition(" - at `$")
        place = f", at {field.strip('.`')}" if field else ""
        sentence = f"its document{place}: {reason[:1].lower()}{reason[1:]}"
    except (ValueError, RecursionError) as error:
        sentence = f"its document is not valid JSON: {error}"
    raise ClipError(printable(sentence, 300))


def footprint(text: str) -> int:
    """Bytes of memory, at most, that the values in a JSON text take up once they are read.

    Objects, lists, their entries and names are counted by what begins or parts them; what one takes
    up at most was measured, the data model's own objects included.
    """
    costs = {"{": 300, "[": 80, ",": 88, ":": 210}
    return 2 * sys.getsizeof(text) + sum(text.count(c) * cost for c, cost in costs.items())


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = {printable(name): _clean(value) for name, value in pairs}
    if len(found) < len(pairs):
        raise ClipError("its document says the same field twice")
    return found


def _clean(value: Any) -> Any:
    """Texts and lists without control characters; objects are clean already."""
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, float) and not math.isfinite(value):
        raise ClipError(f"its document holds {value}; finite numbers are needed")
    return [_clean(item) for item in value] if isinstance(value, list) else value


def write_document(content: Mapping[str, Any], checksums: Mapping[str, str]) -> str:
    """A document as JSON, byte for byte the same for the same content.

    The version and, to those of the buffers by name, the document's own checksum are added.
    """
    fields = to_builtins(content, enc_hook=lambda number: number.item())  # numpy's numbers
    fields["version"] = f"{MAJOR}.{MINOR}"
    fields["sha256"] = {**checksums, DOCUMENT: BLANK}
    fields["sha256"][DOCUMENT] = checksum(_dumped(fields).encode())
    return _dumped(fields)


def _dumped(fields: dict[str, Any]) -> str:
    text = json.dumps(
        fields, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
    )
    return printable(text)  # names of files need not be UTF-8


def checksum(content: Any) -> str:
    """SHA-256 of bytes, or of an array in C order, in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def document_checksum(text: str, written: Mapping[str, str]) -> bool:
    """Whether a document has the checksum that it says: of its text with zeros in the very place,
    because no text can hold a checksum of itself.
    """
    own = written.get(DOCUMENT, BLANK)
    return checksum(text.replace(own, BLANK).encode()) == own
