"""The version of the distribution, and the type of the option by which each command prints it."""

from typing import Annotated

import typer

__version__ = "0.1.0"  # pyproject.toml reads it here, so a checkout knows it without installing


def _print_version(context: typer.Context, wanted: bool) -> None:
    if wanted:
        typer.echo(f"{context.info_name} {__version__}")
        raise typer.Exit


VersionOption = Annotated[
    bool,
    typer.Option("--version", help="Print the version.", is_eager=True, callback=_print_version),
]
