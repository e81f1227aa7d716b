"""Checks a clip to its last byte: all that opening it checks, and every checksum."""

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
    holds: str = ""  #: how much there is in the clip; empty where it can't be read

    @property
    def whole(self) -> bool:
        return not self.findings


def check(path: str | os.PathLike[str]) -> Report:
    """Read all of a file, whatever it is, and report everything that is wrong with it."""
    findings = []
    try:
        container = open_container(Path(path))
        document = read_document(container.text, container.size)
    except ClipError as error:
        return Report((str(error),))
    try:
        clip_in(container, document)
    except ClipError as error:
        findings.append(str(error))
    checksums = "no checksums: it was written before format 1.1"
    if document.sha256:
        checksums = f"{len(document.sha256)} checksums agree"
    holds = (
        f"{len(document.scans)} scans, {len(document.intervals)} intervals, "
        f"{len(container.buffers)} buffers, {container.size:,} bytes, {checksums}"
    )
    return Report((*findings, *_mismatches(container, document)), holds)


def _mismatches(container: Container, document: Document) -> Iterator[str]:
    written = document.sha256
    if not written:
        return
    if not document_checksum(container.text, written):
        yield "its document does not have the checksum that was written with it"
    intervals = {
        f"{index:04d}": f"interval {index:04d} ({i.start:g} to {i.end:g} {document.time_unit}): "
        for index, i in enumerate(document.intervals)
    }
    for name, buffer in container.buffers.items():
        which = f'{intervals.get(name.partition("/")[0], "")}its buffer "{name[:40]}"'
        if name not in written:
            yield f"{which} has no checksum"
        elif checksum(buffer) != written[name]:
            yield f"{which} does not have the checksum that was written with it"
