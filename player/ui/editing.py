"""What is said of chosen organs, undone and made again: functions from scenes to scenes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gclip.corrections import Correction
from player.ui.actions import NO_ORGAN, Move
from player.view.edits import Edits, sentence

if TYPE_CHECKING:
    from player.view.state import Scene

NO_PAIR = "Click an organ, then another one with Shift held, on this day or another."
NO_EDITS = "Organs are corrected in a clip's own file: open it with `play`."
BAKE_AGAIN = "bake again to see it"


def correct(kind: str, name: str = "") -> Move:
    """Say of the chosen organs that they are the same, or not; of one, its name, or cut it."""

    def put_right(scene: Scene) -> Scene:
        needed = 2 if kind in ("same", "different") else 1
        if len(scene.chosen) < needed:
            return scene.with_notice(NO_PAIR if needed == 2 else NO_ORGAN)
        if scene.edits is None:
            return scene.with_notice(NO_EDITS)
        correction = Correction(kind, scene.chosen[:needed], name)  # type: ignore[arg-type]
        told = sentence(correction) + ("" if name else f": {BAKE_AGAIN}")
        return edit(scene.edits.changed((*scene.edits.now, correction)))(scene).with_notice(told)

    return put_right


def edit(edits: Edits) -> Move:
    return lambda scene: replace(scene, edits=edits)


def undo(scene: Scene) -> Scene:
    return scene if scene.edits is None else edit(scene.edits.undone())(scene)


def redo(scene: Scene) -> Scene:
    return scene if scene.edits is None else edit(scene.edits.redone())(scene)
