"""What people put right about a plant's organs: a TOML file beside its clip (docs/corrections.md).

An organ is named by a point of a scan, in the scan's own coordinates: bakes number organs anew, and
the point stays on the same leaf.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

from msgspec import Meta, Struct

from gclip.config_file import read_config
from gclip.terminal.atomic import atomic_file

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
    """Read a file of corrections. Raises UserError with one sentence on what is wrong with it."""
    corrections = Corrections(read_config(path, _File, MAX_FILE_SIZE).correction)
    corrections.file = str(path)
    return corrections


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
