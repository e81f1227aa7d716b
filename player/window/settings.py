"""Settings of the window that are kept between sessions."""

from contextlib import suppress
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta
from platformdirs import user_config_path

from player.view.style import GroundChoice

FILE = "window.json"

Side = Annotated[int, Meta(ge=320, le=16384)]  # units of 1/96 inch


class Settings(msgspec.Struct, frozen=True):
    """Settings of the window, with their defaults."""

    size: tuple[Side, Side] = (1280, 720)  #: (width, height) of the window
    panel: bool = True  #: whether the panel is open
    ground: GroundChoice = GroundChoice.DARK
    guides: bool = True  #: whether scale bar and axes are shown
    legend: bool = True  #: whether the legend is shown


def load_settings() -> Settings:
    """Read the saved settings; defaults if the file is missing or invalid."""
    try:
        return msgspec.json.decode((_folder() / FILE).read_bytes(), type=Settings)
    except (OSError, ValueError, msgspec.DecodeError, RecursionError):
        return Settings()


def save_settings(settings: Settings) -> None:
    """Write settings; a folder that is not writable is ignored."""
    with suppress(OSError):
        _folder().mkdir(parents=True, exist_ok=True)
        (_folder() / FILE).write_bytes(msgspec.json.encode(settings))


def _folder() -> Path:
    return user_config_path("plant-growth-clips", appauthor=False)
