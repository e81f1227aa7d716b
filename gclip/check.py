"""Check a clip to its last byte: everything that opening it checks, and all checksums."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from gclip.clip import clip_in
from gclip.document import checksum, has_own_checksum, read_document
from gclip.errors import ClipError
from gclip.file import Container, open_container
from gclip.schema import Document


@dataclass(frozen=True)
class Report:
    """The result of checking one file."""

    findings: tuple[str, ...]  #: what is wrong, sentences without a full stop
    contents: str = ""  #: what the clip contains; "" where it can't be read

    @property
    def whole(self) -> bool:
        return not self.findings


def check(path: str | os.PathLike[str]) -> Report:
    """Read all of a file and report everything that is wrong with it."""
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
    contents = (
        f"{len(document.scans)} scans, {len(document.intervals)} intervals, "
        f"{len(container.buffers)} buffers, {container.size:,} bytes, {checksums}"
    )
    return Report((*findings, *_checksum_errors(container, document)), contents)


def _checksum_errors(container: Container, document: Document) -> Iterator[str]:
    written = document.sha256
    if not written:
        return
    if not has_own_checksum(container.text, written):
        yield "its document does not have the checksum that was written with it"
    intervals = {
        f"{index:04d}": f"interval {index:04d} ({i.start:g} to {i.end:g} {document.time_unit}): "
        for index, i in enumerate(document.intervals)
    }
    for name, buffer in container.buffers.items():
        subject = f'{intervals.get(name.partition("/")[0], "")}its buffer "{name[:40]}"'
        if name not in written:
            yield f"{subject} has no checksum"
        elif checksum(buffer) != written[name]:
            yield f"{subject} does not have the checksum that was written with it"
