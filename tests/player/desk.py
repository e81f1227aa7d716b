"""The interface without a window: what lies over the plant, drawn by EGL, and worked by a mouse."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
import pytest
from imgui_bundle import imgui
from numpy.typing import NDArray

from gclip import Clip
from player.ui import panel, widgets
from player.ui.gui import OUTSIDE_WINDOW, Gui
from player.ui.interface import Interface
from player.ui.timeline import Line
from player.view.camera import Camera
from player.view.colors import Colors
from player.view.playback import Timeline
from player.view.state import Scene
from player.view.style import Style

GROUND = (30, 60, 90)
SIZE = (900.0, 600.0)

BUTTONS = ("left", "right", "middle")  # in GLFW's order

Place = tuple[float, float, float, float]  # left, top, right, bottom


def scene_of(clip: Clip, day: float = 0.0, **changes: Any) -> Scene:
    """What a window shows of a clip at first, paused on a day."""
    camera, style = Camera.home(clip), Style(**changes)
    timeline = Timeline.of(clip.times).at(day)
    return Scene(timeline, camera, camera, style, (clip,))


class Places:
    """Where the last picture had its controls: by action, or their label where they have none."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.found: dict[str, Place] = {}
        tip = widgets.tip

        def placed(name: str) -> None:
            self.note(name)
            tip(name)

        for module in (widgets, panel):
            patch.setattr(module, "tip", placed)
        for name in ("invisible_button", "collapsing_header", "selectable", "input_text_with_hint"):
            patch.setattr(imgui, name, self._noting(getattr(imgui, name)))

    def note(self, name: str) -> None:
        self.found[name] = (*imgui.get_item_rect_min(), *imgui.get_item_rect_max())

    def _noting(self, control: Any) -> Any:
        def call(label: str, *rest: Any) -> Any:
            result = control(label, *rest)
            self.note(label)
            return result

        return call


class Desk:
    """An interface over an even ground."""

    def __init__(
        self,
        context: moderngl.Context,
        clip: Clip,
        scene: Scene | None = None,
        size: tuple[float, float] = SIZE,
        scale: float = 1.0,
        name: str = "a clip",
    ) -> None:
        self.context, self.clip, self.size, self.scale = context, clip, size, scale
        self.scene = scene or scene_of(clip)
        self.framebuffer = context.simple_framebuffer(
            (round(size[0] * scale), round(size[1] * scale)), 3
        )
        self.gui = Gui()
        self.interface = Interface(self.gui, Colors(clip), name)
        self.patch = pytest.MonkeyPatch()
        self.places = Places(self.patch).found
        self.clicked: tuple[float, float] | None = None
        self.draw(3)

    def draw(self, times: int = 1) -> Scene:
        """Draw it, often enough for windows that find their own size and for queued events."""
        for _ in range(times):
            self.framebuffer.clear(*(value / 255 for value in GROUND))
            self.places.clear()
            self.scene = self.interface.draw(
                self.framebuffer, self.scene, self.size, self.scale, ()
            )
            self.clicked = self.interface.mouse.clicked or self.clicked
            assert self.context.error == "GL_NO_ERROR"
        return self.scene

    def pixels(self) -> NDArray[np.uint8]:
        """(height, width, 3) uint8, top row first."""
        width, height = self.framebuffer.size
        pixels = np.frombuffer(self.framebuffer.read(components=3, alignment=1), np.uint8)
        return pixels.reshape(height, width, 3)[::-1]

    def color_at(self, x: float, y: float) -> NDArray[np.int64]:
        return self.pixels()[round(y * self.scale), round(x * self.scale)].astype(int)

    def middle(self, name: str) -> tuple[float, float]:
        left, top, right, bottom = self.places[name]
        return (left + right) / 2, (top + bottom) / 2

    @property
    def line(self) -> Line:
        """The timeline's."""
        left, top, right, bottom = self.places["timeline"]
        half = (bottom - top) / 4
        return Line(left + half, right - half, (top + bottom) / 2, tuple(self.clip.times))

    def move(self, x: float, y: float) -> None:
        """The mouse came to (x, y)."""
        imgui.get_io().add_mouse_pos_event(x, y)

    def press(self, button: str, down: bool, shift: bool = False) -> None:
        """One of BUTTONS went down, or up."""
        imgui.get_io().add_key_event(imgui.Key.mod_shift, shift)
        imgui.get_io().add_mouse_button_event(BUTTONS.index(button), down)

    def point(self, at: str | tuple[float, float]) -> Scene:
        self.move(*(self.middle(at) if isinstance(at, str) else at))
        return self.draw(2)

    def leave(self) -> None:
        self.point(OUTSIDE_WINDOW)

    def click(self, at: str | tuple[float, float], button: str = "left") -> Scene:
        """Press and release; both may come before the next picture."""
        self.point(at)
        for down in (True, False):
            self.press(button, down)
        return self.draw(3)

    def drag(
        self, start: str | tuple[float, float], end: tuple[float, float],
        button: str = "left", shift: bool = False,
    ) -> Scene:  # fmt: skip
        """Press, move and release."""
        self.point(start)
        self.press(button, True, shift)
        self.draw()
        self.move(*end)
        self.draw(2)
        self.press(button, False, shift)
        return self.draw(2)

    def wheel(self, notches: float) -> Scene:
        imgui.get_io().add_mouse_wheel_event(0.0, notches)
        return self.draw(2)

    def release(self) -> None:
        self.patch.undo()
        self.interface.organs.release()
        self.gui.release()
