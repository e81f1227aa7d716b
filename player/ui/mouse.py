"""What the mouse does to the plant, where no control takes it."""

from __future__ import annotations

from imgui_bundle import imgui

from player.ui import keys
from player.ui.gui import BUTTONS, NOWHERE, STILL
from player.view.choices import Compare
from player.view.state import Scene


class PlantMouse:
    """What it holds. clicked: where the plant was clicked in the last picture; more: with Shift."""

    def __init__(self) -> None:
        self._held: tuple[int, keys.Drag] | None = None
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
            number, drag = self._held
            scene = drag.do(scene, io.mouse_delta.x / size[1], io.mouse_delta.y / size[1])
            if not imgui.is_mouse_down(number):
                self._held = None
                if number == 0 and io.mouse_drag_max_distance_sqr[0] <= STILL**2:
                    self.clicked, self.more = (x, y), drag.shift
        if io.want_capture_mouse or scene.help or x == NOWHERE:
            return scene
        for number, name in enumerate(BUTTONS):
            found = keys.drag_for(name, io.key_shift)
            if imgui.is_mouse_clicked(number) and found and self._held is None:
                self._held = number, found
        if io.mouse_wheel:
            middle = size[0] / 2
            if scene.compare is Compare.BESIDE:
                middle *= 0.5 if x < middle else 1.5
            right, up = (x - middle) / size[1], (size[1] / 2 - y) / size[1]
            scene = keys.wheeled(scene, io.mouse_wheel, right, up)
        return scene
