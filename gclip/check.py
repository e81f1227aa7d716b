"""Checks a clip to its last byte: all that opening it checks, and every checksum."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path

from gclip.container import Container, header_length, open_container
from gclip.document import DOCUMENT, checksum, document_checksum
from gclip.errors import ClipError
from gclip.fields import SPARE, Fields, footprint, parse
from gclip.file import clip_in
from gclip.text import printable


@dataclass(frozen=True)
class Finding:
    """What is wrong, as one sentence without a full stop, and where.

    buffer:   the name of the buffer that is wrong, "" where it is none.
    interval: what its interval is, for people; "" where the buffer is none's.
    """

    what: str
    buffer: str = ""
    interval: str = ""

    def __str__(self) -> str:
        return f"{self.interval}: {self.what}" if self.interval else self.what


@dataclass(frozen=True)
class Report:
    """What a check of one file came to.

    findings: all that is wrong, empty for a whole clip.
    size:     of the file, in bytes; 0 where it can't be read.
    buffers:  how many there are; verified: how many have a checksum, the document counted too.
    """

    findings: tuple[Finding, ...]
    size: int = 0
    scans: int = 0
    intervals: int = 0
    buffers: int = 0
    verified: int = 0

    @property
    def whole(self) -> bool:
        return not self.findings


def check(path: str | os.PathLike[str]) -> Report:
    """Read all of a clip and tell everything that is wrong with it; raises nothing.

    Clips written before format 1.1 have no checksums: `verified` is 0 then.
    """
    try:
        container = open_container(Path(path))
    except ClipError as error:
        return Report((_cut_short(Path(path)) or Finding(str(error)),))
    try:
        clip, refusal = clip_in(container), None
    except ClipError as error:
        clip, refusal = None, Finding(str(error))
    try:
        root = parse(container.document, container.size)
        written = _checksums(root)
    except ClipError as error:
        return Report((refusal or Finding(str(error)),), container.size)
    findings = [] if refusal is None else [refusal]
    findings += _mismatches(container, root, written)
    return Report(
        findings=tuple(findings),
        size=container.size,
        scans=len(clip.scans) if clip else 0,
        intervals=len(clip.intervals) if clip else 0,
        buffers=len(container.layout),
        verified=len(written),
    )


def _checksums(root: Fields) -> dict[str, str]:
    """What was written, by the buffer's name; empty for a clip without checksums."""
    if not root.present("sha256"):
        return {}
    found = root.object("sha256")
    return {name: found.text(name) for name in found.value}


def _mismatches(container: Container, root: Fields, written: dict[str, str]) -> list[Finding]:
    if not written:
        return []
    findings = []
    own = written.get(DOCUMENT, "")
    if document_checksum(container.document, own) != own:
        findings.append(Finding("its document does not have the checksum that was written with it"))
    for name in container.layout:
        where = _interval(root, name)
        if name not in written:
            findings.append(Finding(f'its buffer "{name[:40]}" has no checksum', name, where))
        elif checksum(container.buffer(name)) != written[name]:
            what = f'its buffer "{name[:40]}" does not have the checksum that was written with it'
            findings.append(Finding(what, name, where))
    return findings


def _interval(root: Fields, name: str) -> str:
    """What people call a buffer's interval, as far as the document tells."""
    number, _, _ = name.partition("/")
    if not (number.isascii() and number.isdigit()):
        return ""
    try:
        header = root.objects("intervals")[int(number)]
        start, end = header.number("start"), header.number("end")
        unit = root.text("time_unit", "days")
    except (ClipError, IndexError, ValueError):
        return f"interval {number}"
    return f"interval {number} ({start:g} to {end:g} {unit})"


def _cut_short(path: Path) -> Finding | None:
    """Where a file ends too early, if that is what is wrong with it: its header tells."""
    try:
        if not path.is_file():
            return None
        size = os.path.getsize(path)
        with open(path, "rb") as file:
            text = file.read(header_length(file.read(8), size)).decode()
        if footprint(text) > SPARE + 2 * size:
            return None
        header = json.loads(text)
        ends = {
            name: 8 + len(text.encode()) + int(entry["data_offsets"][1])
            for name, entry in header.items()
            if name != "__metadata__"
        }
        needed = max(ends.values())
    except (ClipError, OSError, ValueError, RecursionError, LookupError, TypeError, AttributeError):
        return None
    if needed <= size:
        return None
    first = min((end, name) for name, end in ends.items() if end > size)[1]
    return Finding(
        f"it is cut short: {size:,} of {needed:,} bytes are there, "
        f'and "{printable(first, 40)}" is the first buffer that is not whole',
        first,
    )
