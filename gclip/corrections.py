"""What people put right about a plant's organs: a TOML file beside its clip (docs/corrections.md).

An organ is named by a point of a scan, in the scan's own coordinates: bakes number organs anew, and
the point stays on the same leaf.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, Literal

from msgspec import Meta, Struct, ValidationError, convert

from gclip.errors import UserError
from gclip.terminal.atomic import atomic_file
from gclip.terminal.text import printable

Text = Annotated[str, Meta(max_length=1000)]
Number = Annotated[float, Meta(ge=-1e12, le=1e12)]
Vector = tuple[Number, Number, Number]

MAX_FILE_SIZE = 1 << 18  # bytes; a number of a million digits takes a hundred times its size
HEADER = "# What was put right about this plant's organs; `bake` reads it, `play` writes it anew.\n"


class Place(Struct, frozen=True, forbid_unknown_fields=True):
    """A point of an organ."""

    scan: Text  # its file's name
    point: Vector  # in that file's coordinates
    organ: Text = ""  # what it was called when it was chosen: for people to read


class Correction(Struct, frozen=True, forbid_unknown_fields=True):
    """Two places are of the same organ, or of different ones; one is where an organ is cut off, or
    of an organ with a name.
    """

    kind: Literal["same", "different", "cut", "name"]
    places: tuple[Place, ...]
    name: Text = ""

    def __post_init__(self) -> None:
        count = 2 if self.kind in ("same", "different") else 1
        if len(self.places) != count:
            raise ValueError(f"{self.kind} needs {count} place{'s' * (count > 1)}")
        if bool(self.name) != (self.kind == "name"):
            raise ValueError("name is needed where the kind is name, and only there")


class Corrections(tuple[Correction, ...]):
    """The corrections of a file, in its order."""

    file: str = ""


class _File(Struct, forbid_unknown_fields=True):
    correction: tuple[Correction, ...] = ()


def corrections_file(clip: Path) -> Path:
    """Where a clip's corrections are: plant.corrections.toml beside plant.gclip."""
    return clip.with_suffix(".corrections.toml")


def read_corrections(path: Path) -> Corrections:
    """Read a file of corrections.

    Raises
    ------
    UserError
        With one sentence: the file, which correction, what was found and what is needed.
    """
    content: Any = {}
    try:
        if path.exists() and not path.is_file():
            raise ValueError("it is not even a regular file")
        if path.stat().st_size > MAX_FILE_SIZE:
            raise ValueError(f"at most {MAX_FILE_SIZE:,} bytes are allowed")
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
        corrections = Corrections(convert(content, _File).correction)
        corrections.file = str(path)
        return corrections
    except OSError as error:
        raise UserError(f"'{path}' can't be read: {error.strerror or error}.") from None
    except ValidationError as error:  # "what is wrong - at `$.correction[0].places[1].point`"
        reason, _, place = str(error).partition(" - at `$")
        with suppress(LookupError, TypeError):  # the name of a field may read like a place
            for index, field in re.findall(r"\[(\d+)\]|\.(\w+)", place):
                content = content[int(index) if index else field]
        number = re.match(r"\.correction\[(\d+)\]", place)
        which = f"correction {int(number[1]) + 1}" if number else "the file"
        found = printable(repr(content), 80)
        raise UserError(f"'{path}', {which}: {found}: {printable(reason, 120)}.") from None
    except (ValueError, RecursionError) as error:
        raise UserError(f"'{path}' is no sound TOML file: {printable(str(error), 200)}.") from None


def write_corrections(path: Path, corrections: Sequence[Correction]) -> None:
    """Write a file of corrections, whole or not at all. Raises OSError."""
    entries = [HEADER]
    for one in corrections:
        name = f"name = {_quoted(one.name)}\n" if one.name else ""
        places = "".join(f"    {_table(place)},\n" for place in one.places)
        entries.append(f'[[correction]]\nkind = "{one.kind}"\n{name}places = [\n{places}]\n')
    with atomic_file(path) as part:
        part.write_text("\n".join(entries), "utf-8")


def _table(place: Place) -> str:
    point = ", ".join(f"{float(f'{axis:.9g}')!r}" for axis in place.point)
    organ = f", organ = {_quoted(place.organ)}" if place.organ else ""
    return f"{{ scan = {_quoted(place.scan)}, point = [{point}]{organ} }}"


def _quoted(text: str) -> str:
    """A string of JSON is one of TOML, but for one control character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
