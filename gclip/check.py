"""Check a clip to its last byte: everything that opening it checks, and all checksums."""

import os
from dataclasses import dataclass
from pathlib import Path

from gclip.clip import clip_in
from gclip.document import BLANK, DOCUMENT, checksum, read_document
from gclip.errors import ClipError
from gclip.file import open_container


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
    try:
        container = open_container(Path(path))
        document = read_document(container.text, container.size)
    except ClipError as error:
        return Report((str(error),))
    findings = []
    try:
        clip_in(container, document)
    except ClipError as error:
        findings.append(str(error))
    checksums = "no checksums: it was written before format 1.1"
    if written := document.sha256:
        blanked = container.text.replace(written.get(DOCUMENT, BLANK), BLANK)
        parts = {**container.buffers, DOCUMENT: blanked.encode()}
        wrong = [name[:40] for name, part in parts.items() if checksum(part) != written.get(name)]
        findings += [f'"{n}" does not have the checksum that was written with it' for n in wrong]
        checksums = f"{len(written)} checksums agree"
    contents = (
        f"{len(document.scans)} scans, {len(document.intervals)} intervals, "
        f"{len(container.buffers)} buffers, {container.size:,} bytes, {checksums}"
    )
    return Report(tuple(findings), contents)
