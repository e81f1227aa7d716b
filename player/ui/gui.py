"""Dear ImGui's context, fonts and events, and mouse control of the camera.

Lengths are in units of 1/96 inch, converted by the screen's content scale. ImGui's own GLFW backend
does not support these units, nor does imgui-bundle's copy of GLFW support Wayland; therefore
`player.window.glfw_window` forwards the events.
"""

import math
import time

import moderngl
from imgui_bundle import imgui

from player.ui.theme import DARK, Theme, apply_theme
from player.ui.widgets import FLAGS, bare_window
from player.view.annotations import BOLD, ICONS, REGULAR, font_path
from player.view.choices import Compare
from player.view.state import Scene

CLICK_TOLERANCE = 4.0  # units that the mouse may move between press and release of a click
OUTSIDE_WINDOW = (-1e6, -1e6)  # position of the mouse while it is outside the window
ZOOM_STEP = 1.12  # zoom factor of one notch of the mouse wheel
ORBIT = math.radians(180.0)  # angle of a drag over the window's height


class Gui:
    """Dear ImGui in the current OpenGL context; its calls go between `begin` and `end` of a frame.

    bold:  the bold font; the default font is the regular one, and both contain the icons.
    theme: the colours of the current frame.
    """

    def __init__(self) -> None:
        self._context = imgui.create_context()
        imgui.set_current_context(self._context)
        io = imgui.get_io()
        io.set_ini_filename("")
        io.set_log_filename("")
        io.mouse_drag_threshold = CLICK_TOLERANCE
        io.config_flags |= imgui.ConfigFlags_.nav_enable_keyboard  # lets Esc close lists
        merged = imgui.ImFontConfig()
        merged.merge_mode = True
        merged.glyph_offset = imgui.ImVec2(0.0, 1.0)
        for name in (REGULAR, BOLD):
            font = io.fonts.add_font_from_file_ttf(font_path(name), 16.0)
            io.fonts.add_font_from_file_ttf(font_path(ICONS), 14.0, merged)
        self.bold, self.theme = font, DARK
        self._last_frame = time.perf_counter()
        imgui.backends.opengl3_init("#version 330")

    def begin(self, size: tuple[float, float], scale: float, theme: Theme) -> None:
        """Begin a frame of (width, height) units with `scale` pixels per unit."""
        imgui.set_current_context(self._context)
        io, now = imgui.get_io(), time.perf_counter()
        io.delta_time = min(max(now - self._last_frame, 1e-4), 1.0)
        self._last_frame = now
        io.display_size = imgui.ImVec2(*size)
        io.display_framebuffer_scale = imgui.ImVec2(scale, scale)
        self.theme = theme
        apply_theme(imgui.get_style(), theme)
        imgui.backends.opengl3_new_frame()
        imgui.new_frame()

    def end(self, framebuffer: moderngl.Framebuffer) -> None:
        """End the frame, and draw it over the contents of a framebuffer."""
        imgui.render()
        framebuffer.use()
        imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())

    def release(self) -> None:
        imgui.set_current_context(self._context)
        imgui.backends.opengl3_shutdown()
        imgui.destroy_context(self._context)

    @property
    def has_events(self) -> bool:
        """Whether there are events that no frame has processed yet."""
        return len(imgui.get_current_context().input_events_queue) > 0

    def send_key(self, key: str) -> None:
        """Send a character, or a key by its GLFW name, to the text field that is edited."""
        io, arrow = imgui.get_io(), getattr(imgui.Key, f"{key}_arrow", None)
        code = getattr(imgui.Key, key.replace("kp_", "keypad_"), arrow)
        if len(key) == 1:
            io.add_input_character(ord(key))
        elif code is not None:
            for down in (True, False):
                io.add_key_event(code, down)

    def captures(self, key: str) -> bool:
        """Whether a key belongs to a text field that is edited, or is Esc and an open list."""
        flags = imgui.PopupFlags_.any_popup_id | imgui.PopupFlags_.any_popup_level
        closes = key == "escape" and imgui.is_popup_open("", flags)
        return closes or bool(imgui.get_io().want_text_input)


class PlantMouse:
    """Mouse control of the camera, outside the controls.

    dragging:   whether a drag turned or shifted the plant in the last frame.
    clicked:    position of a click on the plant in the last frame.
    with_shift: whether Shift was held.
    """

    def __init__(self) -> None:
        self.dragging = self.with_shift = False
        self.clicked: tuple[float, float] | None = None

    def move(self, scene: Scene, size: tuple[float, float]) -> Scene:
        """Apply drags and the wheel to the scene's camera, in a view of `size` units."""
        io, flags = imgui.get_io(), imgui.ButtonFlags_
        with bare_window("plant", (0.0, 0.0), size, FLAGS.no_bring_to_front_on_focus):
            buttons = flags.mouse_button_left | flags.mouse_button_right | flags.mouse_button_middle
            imgui.invisible_button("plant", size, buttons)
            self.dragging, hovered = imgui.is_item_active(), imgui.is_item_hovered()
            pressed, released = imgui.is_item_activated(), imgui.is_item_deactivated()
        x, y = io.mouse_pos
        self.with_shift, self.clicked = io.key_shift, None
        if released and imgui.is_mouse_released(0):
            # ImGui's maximum distance of a drag does not include the motion of the last frame.
            last = math.hypot(*imgui.get_mouse_drag_delta(0, 0.0))
            if max(math.sqrt(io.mouse_drag_max_distance_sqr[0]), last) <= CLICK_TOLERANCE:
                self.clicked = x, y
        # The motion before the press is not part of the drag; the motion before the release is.
        if (self.dragging and not pressed) or released:
            right, down = io.mouse_delta.x / size[1], io.mouse_delta.y / size[1]
            orbits = not io.key_shift and (imgui.is_mouse_down(0) or imgui.is_mouse_released(0))
            scene = scene.with_camera(
                lambda c: c.orbit(-ORBIT * right, ORBIT * down) if orbits else c.pan(right, -down)
            )
        elif io.mouse_wheel and hovered:
            center = size[0] / 2
            if scene.compare is Compare.BESIDE:
                center *= 0.5 if x < center else 1.5
            factor = ZOOM_STEP**io.mouse_wheel
            right, up = (x - center) / size[1], (size[1] / 2 - y) / size[1]
            scene = scene.with_camera(lambda c: c.zoom_at(factor, right, up))
        return scene
