"""Clips, the files that they come from, and the corrections that are kept beside them."""

import os
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from msgspec import ValidationError, convert

import gclip
from corrections import Correction, corrections_file, read_corrections, write_corrections
from gclip import Clip
from gclip.errors import UserError
from player.view.choices import Edits
from player.view.state import Scene


@dataclass(frozen=True)
class OpenClip:
    """A clip, what the user calls it, and the file that it comes from, if any."""

    clip: Clip
    name: str
    file: Path | None = None

    @classmethod
    def of(cls, file: Path) -> Self:
        """Raises ClipError where it is no clip."""
        return cls(gclip.open(file), file.stem, file)


class FileWatch:
    """Notices when files are replaced, as `bake` does by renaming; missing ones are awaited."""

    def __init__(self, *files: Path) -> None:
        self._seen: dict[Path, object] = dict.fromkeys(files)
        self.changed()

    def changed(self) -> bool:
        """Whether any of them is another file than at the last look."""
        before = dict(self._seen)
        for file in before:
            with suppress(OSError):
                state = os.stat(file)
                self._seen[file] = state.st_ino, state.st_size, state.st_mtime_ns
        return before != self._seen


class KeptEdits:
    """Of one clip: a file that people may edit while the window is open."""

    def __init__(self, opened: OpenClip) -> None:
        self._baked = baked_corrections(opened.clip)
        self._file = None if opened.file is None else corrections_file(opened.file)
        self._watch = FileWatch(*[self._file] if self._file else [])
        self._saved: Edits | None = None

    def written(self, scene: Scene) -> Scene:
        """Write what the scene changed, or take over what the file says now."""
        if self._file is None:
            return scene
        edits, reads = scene.edits, self._saved is None or self._watch.changed()
        try:
            if reads:
                now = read_corrections(self._file) if self._file.exists() else ()
                edits = replace(edits or Edits(), baked=self._baked)
                edits = edits if now == edits.now else edits.changed(now)
            elif edits and not (self._saved and edits.now == self._saved.now):
                write_corrections(self._file, edits.now)
                self._watch.changed()
        except UserError as error:
            edits = None if reads else self._saved
            self._saved = self._saved or Edits()
            return replace(scene, edits=edits, notice=str(error))
        self._saved = edits or self._saved
        return replace(scene, edits=edits)


def baked_corrections(clip: Clip) -> tuple[Correction, ...]:
    """The corrections that a clip was baked with, as its provenance lists them."""
    with suppress(LookupError, TypeError, ValidationError):  # provenance may hold anything
        return convert(clip.provenance["options"]["corrections"], tuple[Correction, ...])
    return ()
