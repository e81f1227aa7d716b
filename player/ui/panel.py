"""The panel at the window's right: every choice in sight, and each of them has a key as well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from player.ui import actions, keys
from player.ui.panel_widgets import Widgets
from player.view.choices import SIZES, Compare
from player.view.style import ColorMode

if TYPE_CHECKING:
    from gclip import Clip
    from player.ui.canvas import Canvas
    from player.ui.theme import Theme
    from player.view.state import Scene

ORGANS_SHOWN = 8  # rows of the list; more are scrolled


@dataclass(frozen=True)
class Exporting:
    """An export under way: its file's name, and steps done of all."""

    name: str
    done: int
    total: int


class Panel:
    """Belongs to one canvas and one clip."""

    def __init__(self, canvas: Canvas, clip: Clip) -> None:
        self._canvas = canvas
        self._clip = clip

    def draw(
        self,
        scene: Scene,
        theme: Theme,
        place: tuple[float, float, float, float],
        exporting: Exporting | None = None,
    ) -> Scene:
        """Draw it at (x, y, width, height), and give the scene as the user changed it with it."""
        with Widgets(self._canvas, theme, place) as widgets:
            for title, section in (
                ("Look", self._look),
                ("Organs", self._organs),
                ("Compare", self._compare),
                ("View", self._view),
                ("Export", self._export),
            ):
                if widgets.section(title, opened=title in ("Look", "Organs", "Export")):
                    scene = section(widgets, scene, exporting)
        return scene

    def _look(self, widgets: Widgets, scene: Scene, _: object) -> Scene:
        style, modes = scene.style, scene.color_modes
        modes += () if scene.has_errors else (ColorMode.ERROR,)  # the answer tells how to get it
        chosen = widgets.choice(
            "Colour", [mode.label for mode in modes], modes.index(scene.color_mode), "color"
        )
        if chosen is not None:
            scene = actions.colored(modes[chosen])(scene)
        if style.pixels is None:
            size = widgets.slider(
                "Points", style.point_size, 0.2, 5.0, "larger", f"{style.point_size:.0%}"
            )
            scene = scene if size is None else scene.styled(point_size=size)
        else:
            size = widgets.slider(
                "Points",
                style.pixels,
                actions.FEWEST,
                actions.MOST,
                "larger",
                f"{style.pixels:.1f} px",
            )
            scene = scene if size is None else scene.styled(pixels=size)
        shading = widgets.slider(
            "Shading", style.eye_dome, 0.0, 3.0, "shading", f"{style.eye_dome:.0%}", False
        )
        scene = scene if shading is None else scene.styled(eye_dome=shading)
        switches = (
            ("pixels", "Sized in pixels", style.pixels is not None),
            ("ground", "Light ground", style.ground == "light"),
            ("floor", "Floor and shadow", style.show_ground),
            ("depth", "Depth cue", style.depth_cue),
            ("guides", "Scale bar, axes", scene.guides),
            ("legend", "Legend", scene.legend),
        )
        return _switched(widgets, scene, switches)

    def _organs(self, widgets: Widgets, scene: Scene, _: object) -> Scene:
        style, table = scene.style, self._clip.track_table
        with widgets.rows(len(table), min(len(table), ORGANS_SHOWN)) as shown:
            for row in shown:
                track = table[row]
                visible = style.alone == row if style.alone is not None else row not in style.hidden
                clicked = widgets.organ(row, track.name, track.color, style.picked == row, visible)
                if clicked == "name":
                    scene = keys.picked(scene, row)
                elif clicked == "eye":
                    scene = actions.hidden_or_shown(row)(scene.styled(alone=None))
        buttons = [("hide", "Hide"), ("alone", "Alone"), ("show all", "Show all")]
        pressed = widgets.buttons(buttons, active="alone" if style.alone is not None else "")
        return keys.action(pressed).do(scene) if pressed else scene

    def _compare(self, widgets: Widgets, scene: Scene, _: object) -> Scene:
        choices = list(Compare)
        names = [choice.value for choice in choices]
        label = "Other clip" if scene.clips > 1 else "With scan"
        chosen = widgets.choice(label, names, choices.index(scene.compare), "compare")
        return scene if chosen is None else actions.compared_by(choices[chosen])(scene)

    def _view(self, widgets: Widgets, scene: Scene, _: object) -> Scene:
        sides = [("front", "Front"), ("side", "Side"), ("behind", "Back"), ("above", "Top")]
        pressed = widgets.buttons(sides) or widgets.buttons([("fit", "Whole plant")])
        if pressed:
            scene = keys.action(pressed).do(scene)
        count = len(scene.path.keys)
        switches = (
            ("parallel", "Parallel", scene.camera.orthographic),
            ("turn", "Go round", scene.turning),
            ("follow", f"Follow path ({count} key{'' if count == 1 else 's'})", scene.following),
        )
        scene = _switched(widgets, scene, switches)
        path = [("add key", "Add key"), ("drop key", "Remove"), ("save path", "Save")]
        pressed = widgets.buttons(path)
        return keys.action(pressed).do(scene) if pressed else scene

    def _export(self, widgets: Widgets, scene: Scene, exporting: Exporting | None) -> Scene:
        from player.export.formats import FORMATS

        output, names = scene.output, [one.example for one in FORMATS]
        chosen = widgets.choice("What", names, names.index(output.example), "format")
        if chosen is not None:
            output = replace(output, example=names[chosen])
        if FORMATS[names.index(output.example)].picture:
            sizes = [f"{s[0]} × {s[1]}" if s else "as the window" for s in SIZES]
            known = SIZES.index(output.size) if output.size in SIZES else 0
            chosen = widgets.choice("Pixels", sizes, known, "size")
            if chosen is not None:
                output = replace(output, size=SIZES[chosen])
        scene = replace(scene, output=output)
        if output.example.endswith(".png"):
            scene = _switched(widgets, scene, (("transparent", "Transparent", output.transparent),))
        if exporting is not None:
            widgets.progress(exporting.done, exporting.total)
        pressed = widgets.buttons(
            [("export", "Stop" if exporting else "Export"), ("picture", "Picture")]
        )
        return keys.action(pressed).do(scene) if pressed else scene


def _switched(widgets: Widgets, scene: Scene, switches: Sequence[tuple[str, str, bool]]) -> Scene:
    """Checkboxes: (action, label, whether it is on)."""
    for action, label, on in switches:
        if widgets.switch(label, on, action):
            scene = keys.action(action).do(scene)
    return scene
