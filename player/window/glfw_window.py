"""GLFW: creation of windows with OpenGL contexts, events, and full screen."""

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
from player.ui.gui import OUTSIDE_WINDOW

Callback = Callable[..., None]

glfw: Any = untyped  # its type stubs lack the parameters of callbacks

MIN_SIZE = (800, 480)  # units of 1/96 inch, in which panel and buttons fit side by side
EXPORT_INSTEAD = "`play CLIP --export film.mp4` works without one"


@dataclass(frozen=True)
class WindowSize:
    """Sizes of a window in screen coordinates, pixels and units, which differ on dense displays."""

    window: tuple[int, int]  #: (width, height) in screen coordinates, which the mouse has, too
    framebuffer: tuple[int, int]  #: (width, height) in pixels, 0 while the window is minimised
    scale: float  #: pixels per unit of 1/96 inch (the system's content scale)

    @classmethod
    def of_window(cls, handle: Any) -> Self:
        """The current sizes of a window."""
        scale = max(glfw.get_window_content_scale(handle)[0], 0.5)
        return cls(glfw.get_window_size(handle), glfw.get_framebuffer_size(handle), scale)

    @property
    def visible(self) -> bool:
        return min(*self.window, *self.framebuffer) > 0

    @property
    def units(self) -> tuple[float, float]:
        """(width, height) in units of 1/96 inch."""
        return self.framebuffer[0] / self.scale, self.framebuffer[1] / self.scale

    def to_units(self, x: float, y: float) -> tuple[float, float]:
        """Convert screen coordinates to units."""
        width, height = self.units
        return x * width / max(self.window[0], 1), y * height / max(self.window[1], 1)

    def pixels_beside(self, panel_width: float) -> tuple[int, int]:
        """(width, height) in pixels of the part beside a panel of some units."""
        width, height = self.framebuffer
        return max(width - round(panel_width * self.scale), 1), height


@contextmanager
def open_window(size: tuple[int, int], title: str) -> Iterator[Any]:
    """Open a window with a current OpenGL context, and close it at the end.

    size: (width, height) in units of 1/96 inch.
    Raises PlayerError if there is no display, or no OpenGL 3.3.
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
        handle = _create_window(size, title)
        if not handle:  # the GPU's driver may be broken; Mesa can draw on the CPU
            os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
            glfw.terminate()  # Mesa selects its driver once per connection to the display
            handle = glfw.init() and _create_window(size, title)
        if not handle:
            raise PlayerError(
                f"this display offers no OpenGL 3.3 ({reasons[-1]}); install a newer graphics "
                f"driver or Mesa (Debian or Ubuntu: apt-get install libgl1), or {EXPORT_INSTEAD}."
            )
        per_unit = glfw.get_window_size(handle)[0] / size[0]
        min_size = (round(per_unit * length) for length in MIN_SIZE)
        glfw.set_window_size_limits(handle, *min_size, glfw.DONT_CARE, glfw.DONT_CARE)
        glfw.make_context_current(handle)
        glfw.swap_interval(1)
        yield handle
    finally:
        glfw.terminate()


def _create_window(size: tuple[int, int], title: str) -> Any:
    """Create a window with the newest OpenGL of VERSIONS; None if there is none."""
    glfw.window_hint(glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)
    glfw.window_hint(glfw.OPENGL_FORWARD_COMPAT, True)
    glfw.window_hint(glfw.CONTEXT_ROBUSTNESS, glfw.LOSE_CONTEXT_ON_RESET)
    glfw.window_hint(glfw.SCALE_TO_MONITOR, True)
    for name in (glfw.X11_CLASS_NAME, glfw.X11_INSTANCE_NAME):  # both are needed
        glfw.window_hint_string(name, "play")
    for version in VERSIONS:
        glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, version // 100)
        glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, version // 10 % 10)
        if handle := glfw.create_window(*size, title, None, None):
            return handle
    return None


def set_callbacks(
    handle: Any, on_press: Callback, refresh: Callable[[], None], drop: Callback
) -> None:
    """Register callbacks for the window's events; events of the mouse go to Dear ImGui.

    on_press: receives the name of a key, with the prefix "ctrl+" if Ctrl is held, or the character
              typed; whether Shift is held; and whether the key repeats.
    refresh:  is called when the system needs the contents of the window again.
    drop:     receives the names of files dropped on the window.
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
            on_press(named[code], shifted, repeating)
        elif action != glfw.RELEASE and shortcut and not modifiers & glfw.MOD_ALT:
            # The name by the keyboard layout, since Z and Y are swapped in some of them.
            on_press(f"ctrl+{glfw.get_key_name(code, scancode)}".lower(), shifted, repeating)

    def on_character(_: Any, code: int) -> None:
        # Characters, not key codes: "?" and "+" are on different keys of different layouts.
        on_press(chr(code), shifted, repeating)

    def on_button(_: Any, code: int, action: int, modifiers: int) -> None:
        if code < imgui.MouseButton_.count:  # the same order as in GLFW
            io.add_key_event(imgui.Key.mod_shift, bool(modifiers & glfw.MOD_SHIFT))
            io.add_mouse_button_event(code, action == glfw.PRESS)

    def on_move(_: Any, x: float, y: float) -> None:
        io.add_mouse_pos_event(*WindowSize.of_window(handle).to_units(x, y))

    def on_enter(_: Any, entered: bool) -> None:
        if not entered and not imgui.is_any_mouse_down():  # drags continue outside
            io.add_mouse_pos_event(*OUTSIDE_WINDOW)

    glfw.set_key_callback(handle, on_key)
    glfw.set_char_callback(handle, on_character)
    glfw.set_mouse_button_callback(handle, on_button)
    glfw.set_cursor_pos_callback(handle, on_move)
    glfw.set_cursor_enter_callback(handle, on_enter)
    glfw.set_scroll_callback(handle, lambda _, right, up: io.add_mouse_wheel_event(0.0, up))
    glfw.set_window_refresh_callback(handle, lambda _: refresh())
    glfw.set_drop_callback(handle, lambda _, names: drop(names))


def switch_fullscreen(handle: Any, fullscreen: bool) -> None:
    """Enter or leave full screen on the monitor that shows the window."""
    if fullscreen == bool(glfw.get_window_monitor(handle)):
        return
    if fullscreen:
        place = *glfw.get_window_pos(handle), *glfw.get_window_size(handle)
        glfw.set_window_user_pointer(handle, place)
        monitor = _monitor_of(handle)
        mode = glfw.get_video_mode(monitor)
        glfw.set_window_monitor(handle, monitor, 0, 0, *mode.size, mode.refresh_rate)
    else:
        glfw.set_window_monitor(handle, None, *glfw.get_window_user_pointer(handle), 0)


def _monitor_of(handle: Any) -> Any:
    """The monitor whose centre is nearest to the centre of a window."""
    (left, top), (width, height) = glfw.get_window_pos(handle), glfw.get_window_size(handle)

    def distance(monitor: Any) -> float:
        x, y, *area = glfw.get_monitor_workarea(monitor)
        return math.hypot(x + area[0] / 2 - left - width / 2, y + area[1] / 2 - top - height / 2)

    return min(glfw.get_monitors(), key=distance)
