"""The version of the distribution, and the option --version of the commands."""

from typing import Annotated

import typer

__version__ = "0.1.0"  # read by pyproject.toml


def _print_version(context: typer.Context, wanted: bool) -> None:
    if wanted:
        typer.echo(f"{context.info_name} {__version__}")
        raise typer.Exit


VersionOption = Annotated[
    bool,
    typer.Option("--version", help="Print the version.", is_eager=True, callback=_print_version),
]
