"""Dear ImGui over the picture: its context, fonts and events, drawn by its own OpenGL backend.

All lengths are in units of 1/96 inch as the screen reports it: the same size on every display. For
their sake, and for Wayland's, which imgui-bundle's copy of GLFW knows nothing of, the window hands
its events on here, in place of ImGui's backend for GLFW.
"""

import time

import moderngl
from imgui_bundle import imgui

from player.ui.theme import DARK, Theme, dress
from player.view.annotations import BOLD, ICONS, REGULAR, font_file

STILL = 4.0  # units that the mouse may move between press and release of a click
NOWHERE = (-1e6, -1e6)  # the mouse, while it is outside the window
BUTTONS = 3  # left, right and middle, in GLFW's order and ImGui's


class Gui:
    """`begin`, ImGui's own calls, `end`: once for every picture, in the OpenGL context in use.

    bold:  the second font; the first is the default, and both have the icons.
    theme: the colours of the picture that has begun.
    """

    def __init__(self) -> None:
        self._own = imgui.create_context()
        imgui.set_current_context(self._own)
        io = imgui.get_io()
        io.set_ini_filename("")
        io.set_log_filename("")
        io.mouse_drag_threshold = STILL
        io.config_flags |= imgui.ConfigFlags_.nav_enable_keyboard  # Esc closes lists
        merged = imgui.ImFontConfig()
        merged.merge_mode = True
        merged.glyph_offset = imgui.ImVec2(0.0, 1.0)
        for name in (REGULAR, BOLD):
            font = io.fonts.add_font_from_file_ttf(font_file(name), 16.0)
            io.fonts.add_font_from_file_ttf(font_file(ICONS), 14.0, merged)
        self.bold, self.theme = font, DARK
        self._then = time.perf_counter()
        imgui.backends.opengl3_init("#version 330")

    def begin(self, size: tuple[float, float], scale: float, theme: Theme) -> None:
        """Begin a picture of a window of (width, height) units, of `scale` pixels each."""
        imgui.set_current_context(self._own)
        io, now = imgui.get_io(), time.perf_counter()
        io.delta_time = min(max(now - self._then, 1e-4), 1.0)
        self._then = now
        io.display_size = imgui.ImVec2(*size)
        io.display_framebuffer_scale = imgui.ImVec2(scale, scale)
        self.theme = theme
        dress(imgui.get_style(), theme)
        imgui.backends.opengl3_new_frame()
        imgui.new_frame()

    def end(self, framebuffer: moderngl.Framebuffer) -> None:
        """Draw it over what `framebuffer` holds already."""
        imgui.render()
        framebuffer.use()
        imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())

    def release(self) -> None:
        imgui.set_current_context(self._own)
        imgui.backends.opengl3_shutdown()
        imgui.destroy_context(self._own)

    @property
    def pending(self) -> bool:
        """Whether events have come that no picture has seen."""
        return len(imgui.get_current_context().input_events_queue) > 0

    def type(self, key: str) -> None:
        """A character, or a key by GLFW's name, for a field that is written in."""
        io, arrow = imgui.get_io(), getattr(imgui.Key, f"{key}_arrow", None)
        found = getattr(imgui.Key, key.replace("kp_", "keypad_"), arrow)
        if len(key) == 1:
            io.add_input_character(ord(key))
        elif found is not None:
            for down in (True, False):
                io.add_key_event(found, down)

    @property
    def writes(self) -> bool:
        """Whether a field is written in."""
        return bool(imgui.get_io().want_text_input)
