"""Checks a clip to its last byte: all that opening it checks, and every checksum."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from gclip.clip import clip_in
from gclip.document import checksum, document_checksum, read_document
from gclip.errors import ClipError
from gclip.file import Container, open_container
from gclip.schema import Document


@dataclass(frozen=True)
class Report:
    """What a check of one file came to."""

    findings: tuple[str, ...]  #: all that is wrong, sentences without a full stop
    size: int = 0  #: of the file in bytes, 0 where it can't be read
    scans: int = 0
    intervals: int = 0
    buffers: int = 0
    verified: int = 0  #: checksums, the document's own counted; 0 before format 1.1

    @property
    def whole(self) -> bool:
        return not self.findings


def check(path: str | os.PathLike[str]) -> Report:
    """Read all of a clip and report everything that is wrong with it.

    Parameters
    ----------
    path : str or path-like
        Any file, or none.

    Returns
    -------
    Report
        Nothing is raised.
    """
    try:
        container = open_container(Path(path))
    except ClipError as error:
        return Report((str(error),))
    try:
        document = read_document(container.text, container.size)
    except ClipError as error:
        return Report((str(error),), container.size)
    findings = []
    try:
        clip_in(container, document)
    except ClipError as error:
        findings.append(str(error))
    return Report(
        findings=(*findings, *_mismatches(container, document)),
        size=container.size,
        scans=len(document.scans),
        intervals=len(document.intervals),
        buffers=len(container.buffers),
        verified=len(document.sha256),
    )


def _mismatches(container: Container, document: Document) -> Iterator[str]:
    written = document.sha256
    if not written:
        return
    if not document_checksum(container.text, written):
        yield "its document does not have the checksum that was written with it"
    for name, buffer in container.buffers.items():
        if name not in written:
            yield f'{_place(document, name)}its buffer "{name[:40]}" has no checksum'
        elif checksum(buffer) != written[name]:
            yield (
                f'{_place(document, name)}its buffer "{name[:40]}" does not have the checksum '
                "that was written with it"
            )


def _place(document: Document, buffer: str) -> str:
    """Which interval a buffer belongs to, for people."""
    number = buffer.partition("/")[0]
    if not (number.isdecimal() and int(number) < len(document.intervals)):
        return ""
    interval = document.intervals[int(number)]
    return f"interval {number} ({interval.start:g} to {interval.end:g} {document.time_unit}): "
