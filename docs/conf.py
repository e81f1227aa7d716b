"""The site: `./run docs`, or `pip install ".[docs]"` and `python -m sphinx -nW docs site`.

Sphinx with MyST and Furo: all three have releases within the year, links between pages and to
headings are checked, and a page that no navigation names is an error. The result needs no network.
"""

import re
from importlib import import_module
from typing import Any

project = "Plant growth clips"
copyright = "the authors, MIT licence"

extensions = ["myst_parser"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 4
exclude_patterns = ["gallery", "examples"]

html_theme = "furo"
html_title = "Plant growth clips"
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f8a4c", "color-brand-content": "#1f8a4c"},
    "dark_css_variables": {"color-brand-primary": "#7ecf98", "color-brand-content": "#7ecf98"},
}

PACKAGES = {"bake": "baker", "play": "player", "grow": "grow"}


def options_of(command: str) -> str:
    """The options of a command by what they are about, as `--help` has them."""
    from typer import Context
    from typer.main import get_command

    parser = get_command(import_module(f"{PACKAGES[command]}.cli").app)
    context = Context(parser, info_name=command)
    panels: dict[str, list[str]] = {}
    for one in parser.get_params(context):
        name, text = one.get_help_record(context)
        panel = getattr(one, "rich_help_panel", None) or ""
        panels.setdefault(panel, []).append(f"`{name.strip()}`\n: {text}\n")
    parts = [f"### {panel}\n\n" * bool(panel) + "\n".join(own) for panel, own in panels.items()]
    return "\n\n".join([f"## {command}", f"`{parser.get_usage(context)}`", *parts])


def fill_in_options(app: Any, docname: str, source: list[str]) -> None:
    """Where a page says `<!-- options of bake -->`."""
    source[0] = re.sub("<!-- options of (.+) -->", lambda m: options_of(m[1]), source[0])


def setup(app: Any) -> None:
    app.connect("source-read", fill_in_options)
