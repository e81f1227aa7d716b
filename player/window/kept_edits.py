"""Corrections of a clip's organs, kept in the file beside it that the next bake reads."""

from dataclasses import replace

from gclip.corrections import corrections_file, read_corrections, write_corrections
from gclip.errors import UserError
from player.view.edits import Edits, baked_corrections
from player.view.state import Scene
from player.window.opened_clip import FileWatch, OpenClip


class KeptEdits:
    """Of one clip: a file that people may edit while the window is open."""

    def __init__(self, opened: OpenClip) -> None:
        self._file = None if opened.file is None else corrections_file(opened.file)
        self._baked = baked_corrections(opened.clip)
        self._watch = FileWatch([] if self._file is None else [self._file])
        self._saved: Edits | None = None

    def written(self, scene: Scene) -> Scene:
        """Write what the scene changed, or take over what the file says now."""
        if self._file is None:
            return scene
        try:
            if self._saved is None or self._watch.changed():
                now = read_corrections(self._file) if self._file.exists() else ()
                before = scene.edits or Edits()
                edits = before if now == before.now else before.changed(now)
                self._saved = replace(edits, baked=self._baked)
                return replace(scene, edits=self._saved)
            if scene.edits and scene.edits.now != self._saved.now:
                write_corrections(self._file, scene.edits.now)
                self._watch.changed()
            self._saved = scene.edits or self._saved
        except UserError as error:
            self._saved = Edits()
            return replace(scene, edits=None).with_notice(str(error))
        except OSError as error:
            why = f"{self._file.name} can't be written: {error.strerror or error}."
            return replace(scene, edits=self._saved).with_notice(why)
        return scene
