"""What the mouse does to the plant, where no control takes it."""

import math

from imgui_bundle import imgui

from player.ui.gui import STILL
from player.ui.widgets import FLAGS, bare_window
from player.view.choices import Compare
from player.view.state import Scene

ZOOM_STEP = 1.12  # factor of one wheel notch
TURN = math.radians(180.0)  # orbit of a drag over the window's height


class PlantMouse:
    """What the mouse did in the last picture.

    drags:   whether it turns or shifts the plant.
    clicked: where the plant was clicked; more: with Shift.
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
        self.more = io.key_shift
        self.clicked = None
        if let_go and imgui.is_mouse_released(0):
            # The farthest distance of a drag leaves out how far the mouse went before the release.
            last = math.hypot(*imgui.get_mouse_drag_delta(0, 0.0))
            if max(math.sqrt(io.mouse_drag_max_distance_sqr[0]), last) <= STILL:
                self.clicked = x, y
        # The way to the place of the press is no drag; the way to that of the release is.
        if (self.drags and not pressed) or let_go:
            right, down = io.mouse_delta.x / size[1], io.mouse_delta.y / size[1]
            left = imgui.is_mouse_down(0) or imgui.is_mouse_released(0)
            turns = left and not io.key_shift
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
