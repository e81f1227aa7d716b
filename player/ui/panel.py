"""The panel at the window's right: every choice in sight, and its key in a tip."""

from dataclasses import replace

from imgui_bundle import imgui, imgui_ctx

from player.export.formats import FORMATS
from player.ui import actions, keys
from player.ui.actions import Choice
from player.ui.gui import Gui
from player.ui.pen import fitted
from player.ui.theme import CLEAR, PADDING, rgb
from player.ui.widgets import button, tip
from player.view.choices import sentence
from player.view.organ_place import organ_place
from player.view.state import Scene
from player.view.style import ColorMode

WIDTH = 272.0
LEAST_BESIDE = 300.0  # what it leaves to the plant
LEAST_HEIGHT = 200.0  # below which it takes the whole window's
SMALL = 13.5  # size of notes
LABEL, EYE = 80.0, 26.0  # widths
LARGEST_SIZE, STRONGEST = 5.0, 2.0  # of points and of the shading, at the sliders' ends
DOT, SEEN, HIDDEN, REMOVE = "\uf111", "\uf06e", "\uf070", "\uf00d"  # icons
HOW = "Click an organ, on another day or beside it one more with Shift held."


def stands_beside(width: float) -> bool:
    """Whether a window is wide enough for the panel beside the plant; else it lies over it."""
    return width >= WIDTH + LEAST_BESIDE


def panel_width(scene: Scene, width: float) -> float:
    """What the panel takes from a window's width: nothing where it would leave too little."""
    return WIDTH if scene.panel and not scene.kiosk and stands_beside(width) else 0.0


def draw_panel(
    scene: Scene, gui: Gui, size: tuple[float, float], strips: tuple[float, float]
) -> Scene:
    """Draw it in a window of (width, height), and give the scene as the mouse changed it.

    strips: heights of what it leaves free above and below where it lies over the plant.
    """
    (width, height), top = size, strips[0]
    between = height - sum(strips)
    if stands_beside(width) or between < LEAST_HEIGHT:
        top, between = 0.0, height
    imgui.set_next_window_pos((max(width - WIDTH, 0.0), top))
    imgui.set_next_window_size((min(WIDTH, width), between))
    flags = imgui.WindowFlags_
    unmoved = (flags.no_decoration & ~flags.no_scrollbar) | flags.no_move | flags.no_nav
    with imgui_ctx.begin("panel", None, unmoved | flags.no_saved_settings):
        for title, section in SECTIONS.items():
            imgui.set_next_item_open(title in ("Look", "Export", "Organs"), imgui.Cond_.once)
            if title == "Corrections" and len(scene.chosen) > 1:
                imgui.set_next_item_open(True)
            with imgui_ctx.push_font(gui.bold, 15.0):
                shown = imgui.collapsing_header(title)
            if shown:
                imgui.push_item_width(-LABEL)
                scene = section(scene)
                imgui.pop_item_width()
    return scene


def _look(scene: Scene) -> Scene:
    scene = _choice(scene, actions.COLOR, "color")
    if scene.color_mode is ColorMode.FIELD and len(scene.clip.fields) > 1:
        scene = _choice(scene, actions.FIELD, "color")
    if scene.color_mode.colormap:
        scene = _choice(scene, actions.COLOR_MAP, "colormap")
    style = scene.style
    if style.pixels is None:
        limits, text = (1 / LARGEST_SIZE, LARGEST_SIZE), f"{style.point_size:.0%}"
        scene = _slider(scene, "Points", "point_size", limits, "larger", text)
    else:
        limits, text = (actions.FEWEST, actions.MOST), f"{style.pixels:.1f} px"
        scene = _slider(scene, "Points", "pixels", limits, "larger", text)
    text = f"{style.eye_dome:.0%}"
    scene = _slider(scene, "Shading", "eye_dome", (0.0, STRONGEST), "shading", text)
    return _switches(scene, "pixels", "ground", "floor", "depth", "guides", "legend")


def _view(scene: Scene) -> Scene:
    scene = _buttons(scene, {"front": "Front", "side": "Side", "behind": "Back", "above": "Top"})
    scene = _buttons(scene, {"fit": "Whole plant"})
    scene = _switches(scene, "parallel", "turn", "follow")
    return _buttons(scene, {"add key": "Add key", "drop key": "Remove", "save path": "Save"})


def _compare(scene: Scene) -> Scene:
    return _choice(scene, actions.COMPARE, "compare")


def _export(scene: Scene) -> Scene:
    scene = _choice(scene, actions.FORMAT, "format")
    if next(one for one in FORMATS if one.example == scene.output.example).picture:
        scene = _choice(scene, actions.SIZE, "size")
    if scene.output.example.endswith(".png"):
        scene = _switches(scene, "transparent")
    export = "Stop" if scene.exporting else "Export"
    return _buttons(scene, {"export": export, "picture": "Picture"})


def _corrections(scene: Scene) -> Scene:
    """The chosen organs, what to say of them, and what was said."""
    edits = scene.edits
    with imgui_ctx.push_font(None, SMALL):
        for line in [f"{place.organ} in {place.scan}" for place in scene.chosen] or [HOW]:
            imgui.text_wrapped(line)
    scene = _buttons(scene, {"same": "Same", "different": "Not same", "cut": "Cut"})
    with imgui_ctx.push_font(None, SMALL):
        for row, one in enumerate(edits.now if edits else ()):
            with imgui_ctx.push_id(str(row)):
                if _icon(REMOVE) and edits:
                    kept = (*edits.now[:row], *edits.now[row + 1 :])
                    scene = replace(scene, edits=edits.changed(kept))
            imgui.same_line()
            imgui.text_unformatted(fitted(sentence(one), imgui.get_content_region_avail().x))
            if imgui.is_item_hovered():
                imgui.set_tooltip(", ".join(place.scan for place in one.places))
        if edits and not edits.is_baked:
            imgui.text_wrapped("Bake again, as before and with --force, to see it.")
    return scene


def _organs(scene: Scene) -> Scene:
    scene = _buttons(scene, {"hide": "Hide", "alone": "Alone", "show all": "Show all"})
    scene = _name(scene)
    clipper = imgui.ListClipper()
    clipper.begin(len(scene.clip.track_table))
    while clipper.step():
        for number in range(clipper.display_start, clipper.display_end):
            with imgui_ctx.push_id(str(number)):
                scene = _organ(scene, number)
    return scene


def _name(scene: Scene) -> Scene:
    """A field for the picked organ's name."""
    picked, edits, table = scene.style.picked, scene.edits, scene.clip.track_table
    if picked is None or edits is None or not scene.chosen:
        return scene
    now, flags = table[picked].name, imgui.InputTextFlags_
    imgui.set_next_item_width(-1.0)
    with imgui_ctx.push_id(str(picked)):
        how = flags.enter_returns_true | flags.auto_select_all
        entered, name = imgui.input_text_with_hint("##called", "name of the organ", now, how)
    name = name.strip()
    if not entered or name in ("", now):
        return scene
    if any(track.name == name for track in table):
        return scene.with_notice(f"Another organ is called {name}; choose another name.")
    return actions.correct(scene, "name", name)


def _organ(scene: Scene, number: int) -> Scene:
    """A row of the list: a click on the name picks the organ, one on the eye hides it."""
    style, organ = scene.style, scene.clip.track_table[number]
    visible = style.alone == number if style.alone is not None else number not in style.hidden
    width = imgui.get_content_region_avail().x - EYE
    picked = imgui.get_style_color_vec4(imgui.Col_.header_active)
    with imgui_ctx.push_style_color(imgui.Col_.header, picked):
        row = (width, imgui.get_frame_height())
        if imgui.selectable("##name", style.picked == number, 0, row)[0]:
            place = organ_place(scene.clip, number, scene.timeline.day)
            scene = actions.pick(scene, number, place, imgui.get_io().key_shift)
    imgui.same_line(PADDING + 6.0)
    imgui.align_text_to_frame_padding()
    imgui.text_colored(imgui.ImVec4(*rgb(organ.color, 1.0 if visible else 0.3)), DOT)
    imgui.same_line(PADDING + 25.0)
    text = imgui.text_unformatted if visible else imgui.text_disabled
    text(fitted(organ.name, width - 34.0))
    imgui.same_line(PADDING + width)
    if _icon(SEEN if visible else HIDDEN):
        scene = scene.with_style(hidden=style.hidden ^ {number}, alone=None)
    return scene


SECTIONS = {
    "Look": _look,
    "View": _view,
    "Compare": _compare,
    "Export": _export,
    "Corrections": _corrections,
    "Organs": _organs,
}


def _icon(icon: str) -> bool:
    """A button that is an icon; whether it is pressed."""
    with imgui_ctx.push_style_color(imgui.Col_.button, imgui.ImVec4(*CLEAR)):
        return bool(imgui.button(icon))


def _choice(scene: Scene, choice: Choice, action: str) -> Scene:
    """A list to choose from."""
    now = choice.now(scene)
    if imgui.begin_combo(f"{choice.label}###{choice.field}", choice.name(now)):
        for value in choice.values(scene):
            if imgui.selectable(choice.name(value), value == now)[0]:
                scene = choice.choose(scene, value)
        imgui.end_combo()
    tip(action)
    return scene


def _slider(
    scene: Scene, label: str, name: str, limits: tuple[float, float], action: str, text: str
) -> Scene:
    """A number of the style, by its name there, and in it how it reads."""
    flags = imgui.SliderFlags_.no_input
    if limits[0] > 0.0:
        flags |= imgui.SliderFlags_.logarithmic
    value = getattr(scene.style, name)
    changed, value = imgui.slider_float(label, value, *limits, text.replace("%", "%%"), flags)
    tip(action)
    return scene.changed(f"style.{name}", value) if changed else scene


def _switches(scene: Scene, *names: str) -> Scene:
    """Checkboxes for actions that turn something on and off."""
    for name in names:
        action = keys.ACTIONS[name]
        label, on = action.help.capitalize(), bool(action.on and action.on(scene))
        if imgui.checkbox(f"{label}###{name}", on)[0]:
            scene = action.do(scene)
        tip(name)
    return scene


def _buttons(scene: Scene, labels: dict[str, str]) -> Scene:
    """Buttons in a row, labels by their actions."""
    gap = imgui.get_style().item_spacing.x
    width = (imgui.get_content_region_avail().x - gap * (len(labels) - 1)) / len(labels)
    for action, label in labels.items():
        scene = button(scene, action, label, (width, 0.0))
        imgui.same_line()
    imgui.new_line()
    return scene
