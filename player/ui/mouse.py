"""What the mouse does to the plant, where no control takes it."""

import math

from imgui_bundle import imgui

from player.ui.gui import BUTTONS, STILL
from player.view.choices import Compare
from player.view.state import Scene

ZOOM_STEP = 1.12  # factor of one wheel notch
TURN = math.radians(180.0)  # orbit of a drag over the window's height


class PlantMouse:
    """What it holds. clicked: where the plant was clicked in the last picture; more: with Shift."""

    def __init__(self) -> None:
        self._held: tuple[int, bool] | None = None  # a button, and whether it shifts the plant
        self.clicked: tuple[float, float] | None = None
        self.more = False

    @property
    def drags(self) -> bool:
        """Whether it turns or shifts the plant."""
        return self._held is not None

    def move(self, scene: Scene, size: tuple[float, float]) -> Scene:
        """The scene as drags and the wheel change it, in a view of `size` units."""
        io, self.clicked = imgui.get_io(), None
        x, y = io.mouse_pos
        if self._held is not None:
            button, shifts = self._held
            right, down = io.mouse_delta.x / size[1], io.mouse_delta.y / size[1]
            scene = scene.with_camera(
                lambda c: c.pan(right, -down) if shifts else c.orbit(-TURN * right, TURN * down)
            )
            if not imgui.is_mouse_down(button):
                self._held = None
                if button == 0 and io.mouse_drag_max_distance_sqr[0] <= STILL**2:
                    self.clicked, self.more = (x, y), shifts
        if io.want_capture_mouse or scene.help or not imgui.is_mouse_pos_valid():
            return scene
        for button in range(BUTTONS):
            if imgui.is_mouse_clicked(button) and self._held is None:
                self._held = button, button > 0 or io.key_shift
        if io.mouse_wheel:
            middle = size[0] / 2
            if scene.compare is Compare.BESIDE:
                middle *= 0.5 if x < middle else 1.5
            away, above = (x - middle) / size[1], (size[1] / 2 - y) / size[1]
            scene = scene.with_camera(lambda c: c.zoom_at(ZOOM_STEP**io.mouse_wheel, away, above))
        return scene
