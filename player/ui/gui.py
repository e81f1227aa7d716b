"""Dear ImGui over the picture: its context, fonts and events, drawn by its own OpenGL backend; and
what the mouse does to the plant.

All lengths are in units of 1/96 inch as the screen reports it: the same size on every display. For
their sake, and for Wayland's, which imgui-bundle's copy of GLFW knows nothing of, the window hands
its events on here, in place of ImGui's backend for GLFW.
"""

import math
import time

import moderngl
from imgui_bundle import imgui

from player.ui.theme import DARK, Theme, dress
from player.ui.widgets import FLAGS, bare_window
from player.view.annotations import BOLD, ICONS, REGULAR, font_file
from player.view.choices import Compare
from player.view.state import Scene

STILL = 4.0  # units that the mouse may move between press and release of a click
NOWHERE = (-1e6, -1e6)  # the mouse, while it is outside the window
ZOOM_STEP = 1.12  # factor of one wheel notch
TURN = math.radians(180.0)  # orbit of a drag over the window's height


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

    def takes(self, key: str) -> bool:
        """Whether a key is for a field that is written in, or is Esc for a list that is open."""
        flags = imgui.PopupFlags_.any_popup_id | imgui.PopupFlags_.any_popup_level
        closes = key == "escape" and imgui.is_popup_open("", flags)
        return closes or bool(imgui.get_io().want_text_input)


class PlantMouse:
    """What the mouse does to the plant, where no control takes it.

    drags:   whether it turns or shifts the plant in the last picture.
    clicked: where it clicked the plant there; more: with Shift.
    """

    def __init__(self) -> None:
        self.drags = self.more = False
        self.clicked: tuple[float, float] | None = None

    def move(self, scene: Scene, size: tuple[float, float]) -> Scene:
        """The scene as drags and the wheel change it, in a view of `size` units."""
        io, flags = imgui.get_io(), imgui.ButtonFlags_
        with bare_window("plant", (0.0, 0.0), size, FLAGS.no_bring_to_front_on_focus):
            every = flags.mouse_button_left | flags.mouse_button_right | flags.mouse_button_middle
            imgui.invisible_button("plant", size, every)
            self.drags, hovered = imgui.is_item_active(), imgui.is_item_hovered()
            pressed, let_go = imgui.is_item_activated(), imgui.is_item_deactivated()
        x, y = io.mouse_pos
        self.more, self.clicked = io.key_shift, None
        if let_go and imgui.is_mouse_released(0):
            # The farthest distance of a drag leaves out how far the mouse went before the release.
            last = math.hypot(*imgui.get_mouse_drag_delta(0, 0.0))
            if max(math.sqrt(io.mouse_drag_max_distance_sqr[0]), last) <= STILL:
                self.clicked = x, y
        # The way to the place of the press is no drag; the way to that of the release is.
        if (self.drags and not pressed) or let_go:
            right, down = io.mouse_delta.x / size[1], io.mouse_delta.y / size[1]
            turns = not io.key_shift and (imgui.is_mouse_down(0) or imgui.is_mouse_released(0))
            scene = scene.with_camera(
                lambda c: c.orbit(-TURN * right, TURN * down) if turns else c.pan(right, -down)
            )
        elif io.mouse_wheel and hovered:
            middle = size[0] / 2
            if scene.compare is Compare.BESIDE:
                middle *= 0.5 if x < middle else 1.5
            away, above = (x - middle) / size[1], (size[1] / 2 - y) / size[1]
            scene = scene.with_camera(lambda c: c.zoom_at(ZOOM_STEP**io.mouse_wheel, away, above))
        return scene
