"""Turns key presses and mouse moves into new scenes, by the table in keys.py. No graphics."""

from __future__ import annotations

from dataclasses import replace

from player import keys
from player.layout import TIMELINE, Layout
from player.scene import Scene


class Controls:
    """What the user holds, and the scene that follows from it.

    scene:  as it stands now.
    layout: where things stand on the screen, None until the first picture.
    cursor: where the mouse is, in units, None while it is outside the window.
    held:   what a mouse button went down on and still holds: a drag of the plant, TIMELINE, or a
            button's name.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.layout: Layout | None = None
        self.cursor: tuple[float, float] | None = None
        self.held: keys.Drag | str | None = None
        self._button = ""

    @property
    def scrubbing(self) -> bool:
        return self.held == TIMELINE

    @property
    def dragging(self) -> bool:
        """Whether the plant is being turned or shifted."""
        return isinstance(self.held, keys.Drag)

    def key(self, name: str, shift: bool = False, repeated: bool = False) -> None:
        """A key, by its name or the character typed, went down, or repeats while it is held."""
        action = (keys.action_for(f"shift+{name}") if shift else None) or keys.action_for(name)
        if action is not None and (action.repeats or not repeated):
            self.scene = action.do(self.scene)

    def press(self, button: str, shift: bool = False) -> None:
        """A mouse button ("left", "middle", "right") went down where the cursor is."""
        if self.cursor is None or self.layout is None or self.held is not None:
            return
        if self.scene.help:
            self.scene = replace(self.scene, help=False)
            return
        place = self.layout.under(*self.cursor) if button == "left" else None
        self.held, self._button = place or keys.drag_for(button, shift), button
        if self.scrubbing:
            self._scrub()

    def move(self, x: float, y: float) -> None:
        """The cursor came to (x, y), in units."""
        before, self.cursor = self.cursor or (x, y), (x, y)
        if self.scrubbing:
            self._scrub()
        elif isinstance(self.held, keys.Drag) and self.layout is not None:
            height = self.layout.size[1]
            right, down = (x - before[0]) / height, (y - before[1]) / height
            self.scene = self.held.do(self.scene, right, down)

    def release(self, button: str) -> None:
        """A mouse button went up; a button on the screen acts if the cursor is still on it."""
        if button != self._button:
            return
        held, self.held, self._button = self.held, None, ""
        if not isinstance(held, str) or held == TIMELINE or not (self.cursor and self.layout):
            return
        if self.layout.under(*self.cursor) == held:
            self.scene = keys.action(held).do(self.scene)

    def wheel(self, notches: float) -> None:
        if not self.scene.help:
            self.scene = keys.wheeled(self.scene, notches)

    def leave(self) -> None:
        """The cursor left the window; a drag goes on."""
        if self.held is None:
            self.cursor = None

    def _scrub(self) -> None:
        if self.layout is not None and self.cursor is not None:
            self.scene = keys.scrubbed(self.scene, self.layout.day_at(self.cursor[0]))
