"""The panel at the window's right: every choice in sight, and each of them has a key as well."""

from collections.abc import Sequence
from typing import Any

from imgui_bundle import imgui, imgui_ctx

from player.export.formats import FORMATS
from player.ui import actions, keys
from player.ui.actions import Choice
from player.ui.corrections import draw_corrections, draw_name
from player.ui.gui import Gui
from player.ui.pen import Pen
from player.ui.theme import CLEAR, PADDING, faint, packed, rgb
from player.ui.widgets import button, key_labels, tip
from player.view.organ_place import organ_place
from player.view.state import Exporting, Scene
from player.view.style import ColorMode

WIDTH = 272.0
LEAST_BESIDE = 300.0  # what it leaves to the plant
LEAST_HEIGHT = 200.0  # below which it takes the whole window's
SMALL = 13.0  # size of the keys
LABEL, VALUE, KEY, ROW = 74.0, 46.0, 26.0, 25.0
LARGEST_SIZE, STRONGEST = 5.0, 2.0  # of points and of the shading, at the sliders' ends
EYE, EYE_CLOSED = "\uf06e", "\uf070"


def panel_width(width: float, wanted: bool) -> float:
    """What the panel takes from a window's width: nothing where it would leave too little."""
    return WIDTH if wanted and stands_beside(width) else 0.0


def stands_beside(width: float) -> bool:
    """Whether a window is wide enough for the panel beside the plant; else it lies over it."""
    return width >= WIDTH + LEAST_BESIDE


def panel_place(
    size: tuple[float, float], strips: tuple[float, float]
) -> tuple[float, float, float, float]:
    """(left, top, width, height): beside the plant, in a narrow window over it.

    strips: heights of what it then leaves free above and below.
    """
    (width, height), (top, bottom) = size, strips
    left, between = max(width - WIDTH, 0.0), height - top - bottom
    if stands_beside(width) or between < LEAST_HEIGHT:
        return left, 0.0, width - left, height
    return left, top, width - left, between


def draw_panel(
    scene: Scene,
    gui: Gui,
    place: tuple[float, float, float, float],
    exporting: Exporting | None = None,
) -> Scene:
    """Draw it at (left, top, width, height), and give the scene as the mouse changed it."""
    imgui.set_next_window_pos(place[:2])
    imgui.set_next_window_size(place[2:])
    flags = imgui.WindowFlags_
    unmoved = (flags.no_decoration & ~flags.no_scrollbar) | flags.no_move | flags.no_nav
    with imgui_ctx.begin("panel", None, unmoved | flags.no_saved_settings):
        pen = Pen(gui, imgui.get_window_draw_list(), place[2:])
        for title, section in (
            ("Look", _look),
            ("View", _view),
            ("Compare", _compare),
            ("Export", lambda scene, pen: _export(scene, pen, exporting)),
            ("Corrections", draw_corrections),
            ("Organs", _organs),
        ):
            with imgui_ctx.push_font(gui.bold, 15.0):
                opened = title in ("Look", "Export", "Organs")
                imgui.set_next_item_open(opened, imgui.Cond_.once)
                if title == "Corrections" and len(scene.chosen) > 1:
                    imgui.set_next_item_open(True)
                shown = imgui.collapsing_header(title)
            if shown:
                scene = section(scene, pen)
    return scene


def _organs(scene: Scene, pen: Pen) -> Scene:
    names = [("hide", "Hide"), ("alone", "Alone"), ("show all", "Show all")]
    active = "alone" if scene.style.alone is not None else ""
    scene = _buttons(scene, pen, names, active)
    table = scene.clip.track_table
    scene = draw_name(scene, table)
    with imgui_ctx.push_style_var(imgui.StyleVar_.item_spacing, (0.0, 0.0)):
        clipper = imgui.ListClipper()
        clipper.begin(len(table), ROW)
        while clipper.step():
            for row in range(clipper.display_start, clipper.display_end):
                with imgui_ctx.push_id(str(row)):
                    scene = _organ(scene, pen, row)
    return scene


def _organ(scene: Scene, pen: Pen, number: int) -> Scene:
    """A row of the list: a click on the name picks the organ, one on the eye hides it."""
    style, theme, organ = scene.style, pen.theme, scene.clip.track_table[number]
    visible = style.alone == number if style.alone is not None else number not in style.hidden
    x, y = imgui.get_cursor_screen_pos()
    width = imgui.get_content_region_avail().x - KEY
    imgui.push_style_color(imgui.Col_.header, imgui.ImVec4(*faint(theme.accent, 0.22)))
    if imgui.selectable("##name", style.picked == number, 0, (width, ROW))[0]:
        place = organ_place(scene.clip, number, scene.timeline.day)
        scene = actions.pick(number, place, imgui.get_io().key_shift)(scene)
    imgui.pop_style_color()
    imgui.same_line()
    icon = EYE if visible else EYE_CLOSED
    imgui.push_style_color(imgui.Col_.button, CLEAR)
    imgui.push_style_color(imgui.Col_.text, theme.muted)
    if imgui.button(f"{icon}##eye", (KEY, ROW)):
        scene = actions.switch_organ(number)(scene)
    imgui.pop_style_color(2)
    dot = packed(rgb(organ.color, 1.0 if visible else 0.3))
    pen.sheet.add_circle_filled((x + 11.0, y + ROW / 2), 5.5, dot)
    name = pen.fitted(organ.name, 15.0, width - 34.0)
    pen.write(x + 25.0, y + ROW / 2, name, 15.0, theme.text if visible else theme.muted)
    return scene


def _look(scene: Scene, pen: Pen) -> Scene:
    absent = () if scene.clip.held_out else (ColorMode.ERROR,)  # the answer tells how to get it
    scene = _choice(scene, pen, "Colour", actions.COLOR, "color", absent)
    if scene.color_mode is ColorMode.FIELD and len(scene.clip.fields) > 1:
        scene = _choice(scene, pen, "Field", actions.FIELD, "color")
    if scene.color_mode.colormap:
        scene = _choice(scene, pen, "Colours", actions.COLOR_MAP, "colormap")
    style = scene.style
    if style.pixels is None:
        limits, text = (1 / LARGEST_SIZE, LARGEST_SIZE), f"{style.point_size:.0%}"
        scene = _slider(scene, pen, "Points", "point_size", limits, "larger", text)
    else:
        limits, text = (actions.FEWEST, actions.MOST), f"{style.pixels:.1f} px"
        scene = _slider(scene, pen, "Points", "pixels", limits, "larger", text)
    text = f"{style.eye_dome:.0%}"
    scene = _slider(scene, pen, "Shading", "eye_dome", (0.0, STRONGEST), "shading", text)
    switches = (
        ("pixels", "Sized in pixels", style.pixels is not None),
        ("ground", "Light background", style.ground == "light"),
        ("floor", "Floor and shadow", style.show_ground),
        ("depth", "Depth cue", style.depth_cue),
        ("guides", "Scale bar, axes", scene.guides),
        ("legend", "Legend", scene.legend),
    )
    return _switches(scene, pen, switches)


def _view(scene: Scene, pen: Pen) -> Scene:
    sides = [("front", "Front"), ("side", "Side"), ("behind", "Back"), ("above", "Top")]
    scene = _buttons(scene, pen, sides)
    scene = _buttons(scene, pen, [("fit", "Whole plant")])
    count = len(scene.path.keys)
    switches = (
        ("parallel", "Parallel", scene.camera.orthographic),
        ("turn", "Go round", scene.turning),
        ("follow", f"Follow path ({count} key{'' if count == 1 else 's'})", scene.following),
    )
    scene = _switches(scene, pen, switches)
    path = [("add key", "Add key"), ("drop key", "Remove"), ("save path", "Save")]
    return _buttons(scene, pen, path)


def _compare(scene: Scene, pen: Pen) -> Scene:
    label = "Other clip" if len(scene.clips) > 1 else "With scan"
    return _choice(scene, pen, label, actions.COMPARE, "compare")


def _export(scene: Scene, pen: Pen, exporting: Exporting | None) -> Scene:
    scene = _choice(scene, pen, "What", actions.FORMAT, "format")
    if next(one for one in FORMATS if one.example == scene.output.example).picture:
        scene = _choice(scene, pen, "Pixels", actions.SIZE, "size")
    if scene.output.example.endswith(".png"):
        switch = ("transparent", "Transparent", scene.output.transparent)
        scene = _switches(scene, pen, [switch])
    both = [("export", "Stop" if exporting else "Export"), ("picture", "Picture")]
    return _buttons(scene, pen, both)


def _choice(
    scene: Scene, pen: Pen, label: str, choice: Choice, action: str, more: Sequence[Any] = ()
) -> Scene:
    """A list to choose from, with `more` than the values that the key goes through."""
    _label(pen, label)
    imgui.set_next_item_width(_room(pen, action))
    now = choice.now(scene)
    if imgui.begin_combo(f"##{label}", choice.name(now)):
        for value in (*choice.values(scene), *more):
            if imgui.selectable(choice.name(value), value == now)[0]:
                scene = choice.choose(scene, value)
        if imgui.is_key_pressed(imgui.Key.escape):
            imgui.close_current_popup()
        imgui.end_combo()
    tip(action)
    _key(pen, action)
    return scene


def _slider(
    scene: Scene,
    pen: Pen,
    label: str,
    name: str,
    limits: tuple[float, float],
    action: str,
    text: str,
) -> Scene:
    """A number of the style, by its name there, and beside it how it reads."""
    flags = imgui.SliderFlags_.no_input
    if limits[0] > 0.0:
        flags |= imgui.SliderFlags_.logarithmic
    _label(pen, label)
    imgui.set_next_item_width(_room(pen, action) - VALUE)
    value = getattr(scene.style, name)
    changed, value = imgui.slider_float(f"##{label}", value, *limits, "", flags)
    tip(action, row=True)
    imgui.same_line()
    imgui.text_unformatted(text)
    _key(pen, action)
    return scene.with_style("", **{name: value}) if changed else scene


def _switches(scene: Scene, pen: Pen, switches: Sequence[tuple[str, str, bool]]) -> Scene:
    """Checkboxes: (action, label, whether it is on)."""
    for action, label, on in switches:
        if imgui.checkbox(f"{label}###{action}", on)[0]:
            scene = keys.action(action).do(scene)
        tip(action)
        _key(pen, action)
    return scene


def _buttons(scene: Scene, pen: Pen, actions: Sequence[tuple[str, str]], active: str = "") -> Scene:
    """Buttons in a row: (action, label)."""
    gap = imgui.get_style().item_spacing.x
    width = (imgui.get_content_region_avail().x - gap * (len(actions) - 1)) / len(actions)
    for action, label in actions:
        ground = faint(pen.theme.accent, 0.35) if action == active else None
        scene = button(scene, action, label, (width, 0.0), ground)
        imgui.same_line()
    imgui.new_line()
    return scene


def _label(pen: Pen, label: str) -> None:
    imgui.align_text_to_frame_padding()
    imgui.text_colored(pen.theme.muted, label)
    imgui.same_line(PADDING + LABEL)


def _room(pen: Pen, action: str) -> float:
    """Width between a label and its key."""
    label = key_labels(keys.action(action).labels)[0]
    return imgui.get_content_region_avail().x - max(KEY, pen.width(label, SMALL) + 12.0)


def _key(pen: Pen, action: str) -> None:
    """The key that does the same, at the end of the row."""
    label = key_labels(keys.action(action).labels)[0]
    bar = imgui.get_style().scrollbar_size if imgui.get_scroll_max_y() > 0 else 0.0
    imgui.same_line(imgui.get_window_width() - PADDING - bar - pen.width(label, SMALL))
    with imgui_ctx.push_font(None, SMALL):
        imgui.text_colored(pen.theme.muted, label)
