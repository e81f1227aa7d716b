"""Clips and the files that they come from."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from gclip import Clip
from gclip.clip import open_as_baked


@dataclass(frozen=True)
class OpenClip:
    """A clip as it was baked, what the user calls it, and the file that it comes from, if any."""

    clip: Clip
    name: str
    file: Path | None = None

    @classmethod
    def of(cls, file: Path) -> Self:
        """Raises ClipError where it is no clip."""
        return cls(open_as_baked(file), file.stem, file)

    def reopened(self) -> Self:
        """As its file is now. Raises ClipError where that is no clip any more."""
        return self if self.file is None else self.of(self.file)


class FileWatch:
    """Notices when files are replaced, as `bake` does by renaming."""

    def __init__(self, files: list[Path]) -> None:
        self._files = {file: _mark(file) for file in files}

    def changed(self) -> bool:
        """Whether any of them is another file than at the last look; a missing one is awaited."""
        found = False
        for file, before in self._files.items():
            now = _mark(file)
            if now is not None and now != before:
                self._files[file], found = now, True
        return found


def _mark(file: Path) -> tuple[int, int, int] | None:
    try:
        state = os.stat(file)
    except OSError:
        return None
    return state.st_ino, state.st_size, state.st_mtime_ns
