"""What GLFW is asked for: a window with OpenGL, its events, and the full screen."""

import math
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Self

import glfw as untyped
from imgui_bundle import imgui

from player.errors import PlayerError
from player.gl.context import VERSIONS
from player.ui.gui import NOWHERE

glfw: Any = untyped  # its stubs leave out what handlers are given

SMALLEST = (800, 480)  # units: room for the panel, and for the buttons beside it
EXPORT_INSTEAD = "`play CLIP --export film.mp4` needs none"


@dataclass(frozen=True)
class Measures:
    """The sizes of a window, which differ on displays of high density."""

    window: tuple[int, int]  #: (width, height) in the system's own coordinates, those of the mouse
    framebuffer: tuple[int, int]  #: (width, height) in pixels; zero while the window is minimised
    scale: float  #: pixels in a unit of 1/96 inch (the system's content scale)

    @classmethod
    def of(cls, handle: Any) -> Self:
        """Those that a window has now."""
        scale = max(glfw.get_window_content_scale(handle)[0], 0.5)
        return cls(glfw.get_window_size(handle), glfw.get_framebuffer_size(handle), scale)

    @property
    def visible(self) -> bool:
        return min(*self.window, *self.framebuffer) > 0

    @property
    def units(self) -> tuple[float, float]:
        """(width, height) in units."""
        return self.framebuffer[0] / self.scale, self.framebuffer[1] / self.scale

    def to_units(self, x: float, y: float) -> tuple[float, float]:
        """From the mouse's coordinates to units."""
        width, height = self.units
        return x * width / max(self.window[0], 1), y * height / max(self.window[1], 1)

    def beside(self, aside: float) -> tuple[int, int]:
        """(width, height) in pixels of what is left beside `aside` units."""
        width, height = self.framebuffer
        return max(width - round(aside * self.scale), 1), height


@contextmanager
def opened(size: tuple[int, int], title: str) -> Iterator[Any]:
    """A window whose OpenGL context is current, closed at the end.

    size: (width, height) in units of 1/96 inch.
    Raises PlayerError where there is no display, or no OpenGL 3.3.
    """
    reasons = ["no reason given"]
    glfw.set_error_callback(
        lambda _, reason: reasons.append(reason.decode(errors="replace").rstrip("."))
    )
    if not glfw.init():
        raise PlayerError(
            f"no window can be opened, because there is no display ({reasons[-1]}); start it on a "
            f"desktop, or {EXPORT_INSTEAD}."
        )
    try:
        handle = _created(size, title)
        if not handle:  # a GPU's driver may be broken; Mesa draws on the CPU, slower
            os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
            glfw.terminate()  # Mesa looks for its drivers once in a connection to the display
            handle = glfw.init() and _created(size, title)
        if not handle:
            raise PlayerError(
                f"this display offers no OpenGL 3.3 ({reasons[-1]}); install a newer graphics "
                f"driver or Mesa (Debian or Ubuntu: apt-get install libgl1), or {EXPORT_INSTEAD}."
            )
        per_unit = glfw.get_window_size(handle)[0] / size[0]
        least = (round(per_unit * length) for length in SMALLEST)
        glfw.set_window_size_limits(handle, *least, glfw.DONT_CARE, glfw.DONT_CARE)
        glfw.make_context_current(handle)
        glfw.swap_interval(1)
        yield handle
    finally:
        glfw.terminate()


def _created(size: tuple[int, int], title: str) -> Any:
    """A window with the newest OpenGL of VERSIONS that there is, or nothing."""
    glfw.window_hint(glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)
    glfw.window_hint(glfw.OPENGL_FORWARD_COMPAT, True)
    glfw.window_hint(glfw.CONTEXT_ROBUSTNESS, glfw.LOSE_CONTEXT_ON_RESET)
    glfw.window_hint(glfw.SCALE_TO_MONITOR, True)
    for name in (glfw.X11_CLASS_NAME, glfw.X11_INSTANCE_NAME):  # one without the other is ignored
        glfw.window_hint_string(name, "play")
    for version in VERSIONS:
        glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, version // 100)
        glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, version // 10 % 10)
        if handle := glfw.create_window(*size, title, None, None):
            return handle
    return None


def listen(
    handle: Any, key: Callable[..., None], again: Callable[[], None], dropped: Callable[..., None]
) -> None:
    """Hand the window's events on: the mouse's to Dear ImGui.

    key:     gets a key's name, after "ctrl+" where that is held, or the character typed; whether
             shift is held; whether it repeats.
    again:   called when the system needs the picture anew.
    dropped: gets the names of files dropped on the window.
    """
    named = {
        code: name.removeprefix("KEY_").lower()
        for name, code in vars(glfw).items()
        if name.startswith("KEY_") and len(name) > len("KEY_A")
    }
    io, repeating, shifted = imgui.get_io(), False, False

    def on_key(_: Any, code: int, scancode: int, action: int, modifiers: int) -> None:
        nonlocal repeating, shifted
        repeating, shifted = action == glfw.REPEAT, bool(modifiers & glfw.MOD_SHIFT)
        shortcut = modifiers & (glfw.MOD_CONTROL | glfw.MOD_ALT | glfw.MOD_SUPER)
        if action != glfw.RELEASE and code in named and not shortcut:
            key(named[code], shifted, repeating)
        elif action != glfw.RELEASE and shortcut and not modifiers & glfw.MOD_ALT:
            # By the layout: Z and Y change places from country to country.
            key(f"ctrl+{glfw.get_key_name(code, scancode)}".lower(), shifted, repeating)

    def on_character(_: Any, code: int) -> None:
        # Characters, not key codes: "?" and "+" are elsewhere on every keyboard layout.
        key(chr(code), shifted, repeating)

    def on_button(_: Any, code: int, action: int, modifiers: int) -> None:
        if code < imgui.MouseButton_.count:  # the same order as in GLFW
            io.add_key_event(imgui.Key.mod_shift, bool(modifiers & glfw.MOD_SHIFT))
            io.add_mouse_button_event(code, action == glfw.PRESS)

    def on_move(_: Any, x: float, y: float) -> None:
        io.add_mouse_pos_event(*Measures.of(handle).to_units(x, y))

    def on_enter(_: Any, entered: bool) -> None:
        if not entered and not imgui.is_any_mouse_down():  # what the mouse holds goes on
            io.add_mouse_pos_event(*NOWHERE)

    glfw.set_key_callback(handle, on_key)
    glfw.set_char_callback(handle, on_character)
    glfw.set_mouse_button_callback(handle, on_button)
    glfw.set_cursor_pos_callback(handle, on_move)
    glfw.set_cursor_enter_callback(handle, on_enter)
    glfw.set_scroll_callback(handle, lambda _, right, up: io.add_mouse_wheel_event(0.0, up))
    glfw.set_window_refresh_callback(handle, lambda _: again())
    glfw.set_drop_callback(handle, lambda _, names: dropped(names))


def switch_fullscreen(handle: Any, wanted: bool) -> None:
    """Go to the full screen of the monitor that shows the window, or back from it."""
    if wanted == bool(glfw.get_window_monitor(handle)):
        return
    if wanted:
        glfw.set_window_user_pointer(
            handle, (*glfw.get_window_pos(handle), *glfw.get_window_size(handle))
        )
        monitor = _monitor_of(handle)
        mode = glfw.get_video_mode(monitor)
        glfw.set_window_monitor(handle, monitor, 0, 0, *mode.size, mode.refresh_rate)
    else:
        glfw.set_window_monitor(handle, None, *glfw.get_window_user_pointer(handle), 0)


def _monitor_of(handle: Any) -> Any:
    """The one whose middle is nearest to a window's."""
    (left, top), (width, height) = glfw.get_window_pos(handle), glfw.get_window_size(handle)

    def distance(monitor: Any) -> float:
        x, y, wide, high = glfw.get_monitor_workarea(monitor)
        return math.hypot(x + wide / 2 - left - width / 2, y + high / 2 - top - height / 2)

    return min(glfw.get_monitors(), key=distance)
