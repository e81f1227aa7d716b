"""What the window remembers from one time to the next."""

from contextlib import suppress
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta
from platformdirs import user_config_path

from player.view.style import GroundChoice

FILE = "window.json"

Side = Annotated[int, Meta(ge=320, le=16384)]  # units


class Settings(msgspec.Struct, frozen=True):
    """As they are on the first day."""

    size: tuple[Side, Side] = (1280, 720)  #: of the window in units of 1/96 inch
    panel: bool = True  #: whether it is open
    ground: GroundChoice = GroundChoice.DARK  #: the background
    guides: bool = True  #: whether they are shown, as `legend`
    legend: bool = True


def load_settings() -> Settings:
    """What was saved last; nothing where there is no such file, or it makes no sense."""
    try:
        return msgspec.json.decode((_folder() / FILE).read_bytes(), type=Settings)
    except (OSError, ValueError, msgspec.DecodeError, RecursionError):
        return Settings()


def save_settings(settings: Settings) -> None:
    """Where the folder can't be written to, nothing is remembered."""
    with suppress(OSError):
        _folder().mkdir(parents=True, exist_ok=True)
        (_folder() / FILE).write_bytes(msgspec.json.encode(settings))


def _folder() -> Path:
    return user_config_path("plant-growth-clips", appauthor=False)
