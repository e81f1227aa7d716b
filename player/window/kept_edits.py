"""Corrections of a clip's organs, kept in the file beside it that the next bake reads."""

from dataclasses import replace
from pathlib import Path

from gclip.corrections import corrections_file, read_corrections, write_corrections
from gclip.errors import UserError
from gclip.places import baked_corrections, with_names
from player.view.edits import Edits
from player.view.state import Scene
from player.window.opened_clip import FileWatch, OpenClip


class KeptEdits:
    """Of one clip: a file that people may edit while the window is open.

    clip: the clip, whose organs have the names that they were given.
    """

    def __init__(self, opened: OpenClip) -> None:
        self._file = None if opened.file is None else corrections_file(opened.file)
        self._baked = baked_corrections(opened.clip)
        self._watch = FileWatch([] if self._file is None else [self._file])
        self._saved: Edits | None = None
        self._opened = self.clip = opened.clip

    def written(self, scene: Scene) -> Scene:
        """Write what the scene changed, or take over what the file says now."""
        if self._file is None:
            return scene
        try:
            if self._saved is None or self._watch.changed():
                return self._read(scene, self._file)
        except UserError as error:
            self._saved = Edits()
            return replace(scene, edits=None).with_notice(str(error))
        try:
            if scene.edits and scene.edits.now != self._saved.now:
                clip = with_names(self._opened, scene.edits.now)
                write_corrections(self._file, scene.edits.now)
                self.clip = clip
                self._watch.changed()
        except UserError as error:
            return replace(scene, edits=self._saved).with_notice(str(error))
        except OSError as error:
            why = f"{self._file.name} can't be written: {error.strerror or error}."
            return replace(scene, edits=self._saved).with_notice(why)
        self._saved = scene.edits or self._saved
        return scene

    def _read(self, scene: Scene, file: Path) -> Scene:
        now = read_corrections(file) if file.exists() else ()
        self.clip = with_names(self._opened, now)
        before = scene.edits or Edits()
        edits = before if now == before.now else before.changed(now)
        self._saved = replace(edits, baked=self._baked)
        return replace(scene, edits=self._saved)
