"""Turns key presses and mouse moves into new scenes, by the table in keys.py. No graphics."""

from __future__ import annotations

from dataclasses import replace

from player.ui import keys
from player.ui.layout import PANEL, TIMELINE, WIPE, Layout
from player.view.choices import Compare
from player.view.state import Scene

STILL = 4.0  # units that the cursor may move between press and release of a click


class Controls:
    """What the user holds, and the scene that follows from it.

    scene:   as it stands now.
    layout:  where things stand on the screen, None until the first picture.
    cursor:  where the mouse is, in units, None while it is outside the window.
    held:    what a mouse button went down on and still holds: a drag of the plant, TIMELINE, WIPE,
             PANEL, or a button's name.
    clicked: where the plant was clicked last, until someone has seen to it.
    turned:  notches of the wheel over the panel, until someone has seen to them.
    popup:   whether the panel has something open that lies beyond its edge.
    touched: counts what happened to the panel.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.layout: Layout | None = None
        self.cursor: tuple[float, float] | None = None
        self.held: keys.Drag | str | None = None
        self.clicked: tuple[float, float] | None = None
        self.turned = 0.0
        self.popup = False
        self.touched = 0
        self._button = ""
        self._pressed_at = (0.0, 0.0)
        self._unseen = self._let_go = False  # of a press on the panel

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
        place = self._place() if button == "left" else None
        self.held, self._button = place or keys.drag_for(button, shift), button
        self._pressed_at = self.cursor
        self.touched += place == PANEL
        self._unseen = place == PANEL
        if self.scrubbing:
            self._scrub()

    def drawn(self) -> None:
        """The panel has seen what is held. A click may be shorter than a picture takes to draw:
        until then a button that went up again counts as held.
        """
        self._unseen = False
        if self._let_go:
            self._let_go, self.held = False, None
            self.touched += 1

    def move(self, x: float, y: float) -> None:
        """The cursor came to (x, y), in units."""
        before, self.cursor = self.cursor or (x, y), (x, y)
        if self.held in (None, PANEL) and PANEL in (self._place(), self._place(before)):
            self.touched += 1
        if self.scrubbing:
            self._scrub()
        elif self.held == WIPE and self.layout is not None:
            share = min(max(x / self.layout.size[0], 0.02), 0.98)
            self.scene = replace(self.scene, wipe=share)
        elif isinstance(self.held, keys.Drag) and self.layout is not None:
            height = self.layout.size[1]
            right, down = (x - before[0]) / height, (y - before[1]) / height
            self.scene = self.held.do(self.scene, right, down)

    def release(self, button: str) -> None:
        """A mouse button went up; a button on the screen acts if the cursor is still on it."""
        if button != self._button:
            return
        if self._unseen:
            self._let_go, self._button = True, ""
            self.touched += 1
            return
        held, self.held, self._button = self.held, None, ""
        if not (self.cursor and self.layout):
            return
        if isinstance(held, keys.Drag):
            if button == "left" and self._near_press(self.cursor):
                self.clicked = self.cursor
            return
        self.touched += held == PANEL
        if held not in (None, TIMELINE, WIPE, PANEL) and self._place() == held:
            self.scene = keys.action(str(held)).do(self.scene)

    def wheel(self, notches: float) -> None:
        if self.scene.help or self.layout is None:
            return
        if self._place() == PANEL:
            self.turned += notches
            self.touched += 1
            return
        (width, height), middle = self.layout.size, self.layout.size[0] / 2
        x, y = self.cursor or (middle, height / 2)
        if self.scene.compare is Compare.BESIDE:
            middle = 0.25 * width if x < middle else 0.75 * width
        right, up = (x - middle) / height, (height / 2 - y) / height
        self.scene = keys.wheeled(self.scene, notches, right, up)

    def leave(self) -> None:
        """The cursor left the window; a drag goes on."""
        if self.held is None:
            self.cursor = None
            self.touched += 1

    def _place(self, at: tuple[float, float] | None = None) -> str | None:
        """What lies under the cursor: see `Layout.under`."""
        at = at or self.cursor
        if at is None or self.layout is None:
            return None
        return PANEL if self.popup else self.layout.under(*at)

    def _near_press(self, at: tuple[float, float]) -> bool:
        return max(abs(a - b) for a, b in zip(at, self._pressed_at, strict=True)) <= STILL

    def _scrub(self) -> None:
        if self.layout is not None and self.cursor is not None:
            self.scene = keys.scrubbed(self.scene, self.layout.day_at(self.cursor[0]))
