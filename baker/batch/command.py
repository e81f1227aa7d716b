"""The work of the command `bake`: a list of what would be baked, one plant or many."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from baker.batch.bake_all import bake_all
from baker.batch.listing import list_plants
from baker.batch.outputs import Outputs, check_output
from baker.batch.plant import bake_one
from baker.batch.plants import find_plants
from baker.errors import InputError
from baker.options import Options


def run(
    inputs: Sequence[Path], output: str, options: Options, outputs: Outputs, list_only: bool
) -> int:
    """List or bake what the inputs are; returns the exit code.

    output: the name after -o as it was typed, as a slash at its end means a folder.
    """
    if outputs.traits is not None:
        check_output(outputs.traits, "a table of traits", ".csv")
    if not output and not list_only:
        raise InputError("-o is missing: the clip to write, such as -o plant.gclip.")
    plants = find_plants(inputs, output)
    if list_only:
        list_plants(plants, inputs, options, outputs.quiet)
        return 0
    if plants:
        return bake_all(plants, options, outputs)
    bake_one(inputs, options, outputs)
    return 0
