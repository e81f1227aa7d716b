"""Read and write files of clips: a safetensors container with a JSON document (docs/format.md).

No code from a file is executed; buffers are views of the memory-mapped file. Control characters in
the document's texts are replaced.
"""

import json
import math
import os
import stat
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any, TypeVar

import msgspec
import numpy as np
from msgspec import DecodeError, Meta, Struct, ValidationError
from numpy.typing import NDArray

from gclip.errors import ClipError
from gclip.terminal.atomic import atomic_file
from gclip.text import printable

T = TypeVar("T")

MAJOR, MINOR = 1, 2  # of the format's version
SPARE_MEMORY = 64 << 20  # bytes that a document's values may occupy beyond twice the file's size
MAX_DEPTH = 32  # of nested objects and lists
DOCUMENT, BLANK = "document", "0" * 64  # the document's checksum is taken with this in its place
KEY = "gclip"
DTYPES = {"U8": np.uint8, "U16": np.uint16, "U32": np.uint32, "F32": np.float32}
identity = attrgetter("st_dev", "st_ino", "st_size", "st_mtime_ns")  # changes if the file does


@dataclass(frozen=True)
class Container:
    """An open file."""

    text: str  #: the document
    buffers: dict[str, NDArray[Any]]  #: read-only views of the file, by name
    size: int  #: of the file, in bytes


def open_container(path: Path) -> Container:
    """Map a file. Raises ClipError, without the file's name, if it is not a complete container.

    safetensors checks that the buffers follow each other without gaps up to the end of the file.
    """
    from safetensors import SafetensorError, safe_open

    buffers = {}
    try:
        before = os.stat(path)
        if not stat.S_ISREG(before.st_mode):
            raise ClipError("not a growth clip, not even a file")
        data = np.asarray(np.memmap(path, np.uint8, "r"))
        first = 8 + int.from_bytes(data[:8].tobytes(), "little")  # byte of the first buffer
        with safe_open(path, framework="numpy") as header:
            text = (header.metadata() or {}).get(KEY)
            if text is None:
                raise ClipError('not a growth clip: a safetensors file without the key "gclip"')
            for name in header.offset_keys():
                view = header.get_slice(name)
                kind, shape = view.get_dtype(), view.get_shape()
                if kind not in DTYPES:
                    found = f'its buffer "{name[:40]}" is of type {kind}'
                    raise ClipError(f"{found}; {', '.join(DTYPES)} are allowed")
                end = first + math.prod(shape) * np.dtype(DTYPES[kind]).itemsize
                buffers[name] = data[first:end].view(DTYPES[kind]).reshape(shape)
                first = end
        if identity(before) != identity(os.stat(path)):
            raise ClipError("it is being written right now; try again")
    except FileNotFoundError:
        raise ClipError("no such file") from None
    except OSError as error:
        raise ClipError(f"it can't be read: {error.strerror or error}") from None
    except (SafetensorError, ValueError) as error:
        reason = printable(str(error), 200)
        raise ClipError(f"not a growth clip, or cut short or damaged ({reason})") from None
    return Container(text, buffers, len(data))


class Header(Struct):
    """The part of a document that does not depend on the version."""

    version: Annotated[str, Meta(max_length=1000, pattern=r"^[0-9]+(\.|$)")]
    sha256: dict[str, Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]] = {}


def decode_document(container: Container, kind: type[T]) -> T:
    """Parse a clip's document and convert it to a dataclass.

    Its attribute `track_table` is the document's list `tracks`, with the index of each as its `id`.
    Raises ClipError, which names the wrong field.
    """
    text = container.text
    # The memory that its values occupy at most, as it was measured for objects, lists and so on.
    values = {"{": 300, "[": 80, ",": 88, ":": 210}
    memory = 3 * sys.getsizeof(text) + sum(text.count(c) * size for c, size in values.items())
    if memory > SPARE_MEMORY + 2 * container.size:
        raise ClipError("its document holds far more values than a file of its size needs")
    try:
        major = msgspec.json.decode(text, type=Header).version.split(".")[0]
        if int(major) > MAJOR:
            raise ClipError(
                f"it was written in clip format {major[:20]}; this program reads up to "
                f"{MAJOR}.{MINOR}, so a newer version of it is needed"
            )
        content = _cleaned(msgspec.json.decode(text))
        with suppress(LookupError, TypeError):  # `convert` says what is wrong with the tracks
            content["track_table"] = content.pop("tracks")
            for index, track in enumerate(content["track_table"]):
                track["id"] = index
        return msgspec.convert(content, kind)
    except ValidationError as error:  # in the form "reason - at `$.field`"
        reason, _, field = str(error).replace("track_table", "tracks").partition(" - at `$")
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


def encode_document(content: Mapping[str, Any], buffers: Mapping[str, Any]) -> str:
    """The document with this content, to which the version and the checksums are added."""
    fields = msgspec.to_builtins(content, enc_hook=lambda number: number.item())  # NumPy scalars
    fields["version"] = f"{MAJOR}.{MINOR}"
    fields["sha256"] = {name: sha256(array).hexdigest() for name, array in buffers.items()}
    fields["sha256"][DOCUMENT] = BLANK
    text = json.dumps(
        fields, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
    )
    text = printable(text)  # the name of a file may not be valid UTF-8
    own = f'"{DOCUMENT}":"{BLANK}"'
    return text.replace(own, own.replace(BLANK, sha256(text.encode()).hexdigest()))


def write_container(path: Path, container: Container, force: bool) -> None:
    """Write a clip's file atomically; equal content gives equal bytes.

    Raises UserError if it can't be written, or exists and `force` is not given.
    """
    from safetensors import SafetensorError
    from safetensors.numpy import save_file

    try:
        with atomic_file(path, force) as part:
            save_file(container.buffers, part, {KEY: container.text})
    except SafetensorError as error:
        raise ClipError(str(error)) from None


def verify_checksums(container: Container) -> str:
    """Tell how many checksums the buffers and the document agree with. Raises ClipError."""
    written = msgspec.json.decode(container.text, type=Header).sha256
    if not written:
        return "no checksums: it was written before format 1.1"
    document = container.text.replace(written.get(DOCUMENT, BLANK), BLANK).encode()
    parts: dict[str, Any] = {**container.buffers, DOCUMENT: document}
    wrong = [n for n, part in parts.items() if sha256(part).hexdigest() != written.get(n)]
    if wrong:
        names = ", ".join(f'"{name[:40]}"' for name in wrong)
        raise ClipError(f"not what its checksums were written for: {names}")
    return f"{len(written)} checksums agree"
