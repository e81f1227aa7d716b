"""Where the letters and icons come from: files of imgui-bundle, found without loading it."""

from functools import cache
from importlib.util import find_spec
from pathlib import Path

REGULAR, BOLD = "Roboto-Regular.ttf", "Roboto-Bold.ttf"
ICONS = "Font_Awesome_6_Free-Solid-900.otf"


@cache
def font_file(name: str) -> str:
    """The path of REGULAR, BOLD or ICONS; "" where imgui-bundle is not installed."""
    spec = find_spec("imgui_bundle")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        for path in sorted((Path(folder) / "assets" / "fonts").rglob(name)):
            return str(path)
    return ""
