"""The command `gclip`, which checks whether clips are complete and undamaged."""

from pathlib import Path
from typing import Annotated

import typer

from gclip.errors import ClipError
from gclip.terminal.command import VersionOption, run_app
from gclip.text import printable

app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.callback()
def gclip_command(version: VersionOption = False) -> None:
    """Look after growth clips. `bake` makes them, `play` shows them."""


@app.command(
    "check", epilog="Exit codes: 0 all whole, 2 wrong usage or one is not, 1 our own fault."
)
def check_command(
    clips: Annotated[list[Path], typer.Argument(metavar="CLIP...", help="Growth clips.")],
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Name damaged clips only.")] = False,
) -> None:
    """Tell whether clips are whole, and what is wrong.

    They are read to the last byte. Every field and every buffer is checked as `play` checks it,
    and against the checksum that `bake` wrote beside it.
    """
    from gclip.clip import check

    damaged = 0
    for path in clips:
        try:
            contents = check(path)
        except ClipError as error:
            damaged += 1
            typer.echo(printable(f"{path}: {error}."))
        else:
            if not quiet:
                typer.echo(printable(f"{path}: whole; {contents}."))
    if damaged:
        subject = "the clip is" if len(clips) == 1 else f"{damaged} of {len(clips)} clips are"
        raise ClipError(f"{subject} not whole.")


def main(argv: list[str] | None = None) -> int:
    """Run `gclip` with these arguments (by default those of the process); returns the exit code."""
    return run_app(app, "gclip", argv)
