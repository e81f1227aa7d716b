"""What the window remembers from one time to the next."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

FILE = "window.json"


@dataclass(frozen=True)
class Settings:
    """Unset ones (None) are as on the first day.

    size:     (width, height) of the window in units of 1/96 inch.
    panel:    whether it is open.
    ground:   "dark" or "light".
    guides, legend: whether they are shown.
    """

    size: tuple[int, int] | None = None
    panel: bool | None = None
    ground: str | None = None
    guides: bool | None = None
    legend: bool | None = None


def load_settings() -> Settings:
    """What was saved last; nothing where there is no such file, or it makes no sense."""
    try:
        document = json.loads((_folder() / FILE).read_text("utf-8"))
    except (OSError, ValueError, RecursionError):
        return Settings()
    return _checked(document) if isinstance(document, dict) else Settings()


def save_settings(settings: Settings) -> None:
    """Whole or not at all; where the folder can't be written to, nothing is remembered."""
    try:
        folder = _folder()
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(
            "w", encoding="utf-8", dir=folder, prefix=f".{FILE}.", delete=False
        ) as part:
            part.write(json.dumps(asdict(settings)) + "\n")
        os.replace(part.name, folder / FILE)
    except OSError:
        pass


def _folder() -> Path:
    from platformdirs import user_config_path

    return user_config_path("plant-growth-clips", appauthor=False)


def _checked(document: dict[str, Any]) -> Settings:
    """Only what could have been written: the file may be older, newer, or changed by hand."""
    found: dict[str, Any] = {}
    for one in fields(Settings):
        value: Any = document.get(one.name)
        if one.name == "size":
            if _is_size(value):
                found["size"] = (value[0], value[1])
        elif one.name == "ground":
            if value in ("dark", "light"):
                found["ground"] = value
        elif isinstance(value, bool):
            found[one.name] = value
    return Settings(**found)


def _is_size(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 2
        and all(isinstance(side, int) and 320 <= side <= 16384 for side in value)
    )
