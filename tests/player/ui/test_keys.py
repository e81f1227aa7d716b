"""The one table: nothing in it is ambiguous, and all of it reaches the help and the handling."""

from player.ui import keys
from player.ui.interface import TOOLS


def test_no_key_means_two_things() -> None:
    actions = [action for section in keys.TABLE.values() for action in section]
    used = [key for action in actions for key in action.keys.split()]
    assert len(used) == len(set(used)) == len(keys.BY_KEY)
    assert len(actions) == len(keys.ACTIONS)


def test_every_named_key_is_one_that_glfw_reports() -> None:
    import glfw

    for action in keys.ACTIONS.values():
        for key in action.keys.split():
            last = key.split("+")[-1] if len(key) > 1 else key
            assert len(last) == 1 or hasattr(glfw, f"KEY_{last.upper()}"), key


def test_every_button_does_an_action() -> None:
    for name in TOOLS:
        assert keys.ACTIONS[name].help


def test_the_help_lists_every_key_and_every_drag() -> None:
    text = keys.help_text()
    shown = {
        label for rows in keys.sections().values() for labels in rows.values() for label in labels
    }
    for action in keys.ACTIONS.values():
        assert set(action.labels) <= shown
        assert action.help in text
    assert {"Drag", "Shift drag", "Right drag", "Middle drag", "Wheel", "Click"} <= shown


def test_labels_read_well() -> None:
    assert keys.label("shift+left") == "Shift ←"
    assert keys.label("+") == "+"
    assert keys.label("h") == "H"
    assert keys.label("page_up") == "PgUp"
