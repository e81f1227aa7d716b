"""Check a clip to its last byte: everything that opening it checks, and all checksums."""

import os
from pathlib import Path

from gclip.clip import clip_in
from gclip.document import BLANK, DOCUMENT, checksum, read_document
from gclip.errors import ClipError
from gclip.file import open_container


def check(path: str | os.PathLike[str]) -> str:
    """Read all of a file; returns what the clip contains.

    Raises ClipError, without the file's name and a full stop, for what is wrong with it.
    """
    container = open_container(Path(path))
    document = read_document(container.text, container.size)
    checksums = "no checksums: it was written before format 1.1"
    if written := document.sha256:
        blanked = container.text.replace(written.get(DOCUMENT, BLANK), BLANK)
        parts = {**container.buffers, DOCUMENT: blanked.encode()}
        wrong = [f'"{n[:40]}"' for n, part in parts.items() if checksum(part) != written.get(n)]
        if wrong:
            raise ClipError(f"not what its checksums were written for: {', '.join(wrong)}")
        checksums = f"{len(written)} checksums agree"
    clip_in(container, document)
    return (
        f"{len(document.scans)} scans, {len(document.intervals)} intervals, "
        f"{len(container.buffers)} buffers, {container.size:,} bytes, {checksums}"
    )
