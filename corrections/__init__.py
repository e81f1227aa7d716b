"""Corrections of a plant's organs by users: a TOML file next to its clip (docs/corrections.md).

An organ is identified by a point of a scan, in the coordinates of the scan's file: every bake
numbers the organs anew, but the point stays on the same organ.
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

MAX_FILE_SIZE = 1 << 18  # bytes; parsing a long number takes a hundred times as much memory
HEADER = "# What was put right about this plant's organs; `bake` reads it, `play` writes it anew.\n"


class Place(Struct, frozen=True, forbid_unknown_fields=True):
    """A point of an organ."""

    scan: Text  # its file's name
    point: Vector  # in that file's coordinates
    organ: Text = ""  # its name when it was selected, for people who read the file


class Correction(Struct, frozen=True, forbid_unknown_fields=True):
    """One correction: two places are on the same organ, or on different ones; one place is where an
    organ is cut off, or on an organ that is renamed.
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
    """The corrections in a file, in their order there."""

    file: str = ""


class _File(Struct, forbid_unknown_fields=True):
    correction: tuple[Correction, ...] = ()


def corrections_file(clip: Path) -> Path:
    """The path of a clip's corrections: plant.corrections.toml next to plant.gclip."""
    return clip.with_suffix(".corrections.toml")


def read_corrections(path: Path) -> Corrections:
    """Read a file of corrections. Raises UserError where it is wrong."""
    corrections = Corrections(read_config(path, _File, MAX_FILE_SIZE).correction)
    corrections.file = str(path)
    return corrections


def write_corrections(path: Path, corrections: Sequence[Correction]) -> None:
    """Write a file of corrections atomically. Raises UserError if it can't be written."""
    entries = [HEADER]
    for each in corrections:
        name = f"name = {_quoted(each.name)}\n" if each.name else ""
        places = "".join(f"    {_table(place)},\n" for place in each.places)
        entries.append(f'[[correction]]\nkind = "{each.kind}"\n{name}places = [\n{places}]\n')
    with atomic_file(path) as part:
        part.write_text("\n".join(entries), "utf-8")


def _table(place: Place) -> str:
    point = ", ".join(f"{float(f'{axis:.9g}')!r}" for axis in place.point)
    organ = f", organ = {_quoted(place.organ)}" if place.organ else ""
    return f"{{ scan = {_quoted(place.scan)}, point = [{point}]{organ} }}"


def _quoted(text: str) -> str:
    """A TOML string: that of JSON, except for one control character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
