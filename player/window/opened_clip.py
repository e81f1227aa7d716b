"""Clips with their files, and the files with corrections of their organs."""

import os
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import gclip
from corrections import corrections_file, read_corrections, write_corrections
from corrections.history import Edits
from corrections.provenance import baked_corrections
from gclip import Clip
from gclip.errors import UserError
from player.view.state import Scene


@dataclass(frozen=True)
class OpenClip:
    """A clip that is shown in a window."""

    clip: Clip
    name: str  #: title for users
    file: Path | None = None  #: that the clip was read from, if any

    @classmethod
    def from_file(cls, file: Path) -> Self:
        """Read a clip; raises ClipError if the file is not a valid one."""
        return cls(gclip.open(file), file.stem, file)


class FileWatch:
    """Detects that files were modified, replaced or created."""

    def __init__(self, *files: Path) -> None:
        self._states: dict[Path, object] = dict.fromkeys(files)
        self.changed()

    def changed(self) -> bool:
        """Whether any file has changed since the last call."""
        previous = dict(self._states)
        for file in previous:
            with suppress(OSError):
                state = os.stat(file)
                self._states[file] = state.st_ino, state.st_size, state.st_mtime_ns
        return previous != self._states


class CorrectionsFile:
    """The corrections file of one clip, which others may edit while the window is open."""

    def __init__(self, opened: OpenClip) -> None:
        self._baked = baked_corrections(opened.clip)
        self._file = None if opened.file is None else corrections_file(opened.file)
        self._watch = FileWatch(*[self._file] if self._file else [])
        self._saved: Edits | None = None

    def synchronized(self, scene: Scene) -> Scene:
        """Read the corrections if the file has changed; if not, write those of the scene."""
        if self._file is None:
            return scene
        edits, must_read = scene.edits, self._saved is None or self._watch.changed()
        try:
            if must_read:
                corrections = read_corrections(self._file) if self._file.exists() else ()
                edits = replace(edits or Edits(), baked=self._baked)
                edits = edits if corrections == edits.current else edits.changed(corrections)
            elif edits and not (self._saved and edits.current == self._saved.current):
                write_corrections(self._file, edits.current)
                self._watch.changed()
        except UserError as error:
            edits = None if must_read else self._saved
            self._saved = self._saved or Edits()
            return replace(scene, edits=edits, notice=str(error))
        self._saved = edits or self._saved
        return replace(scene, edits=edits)
