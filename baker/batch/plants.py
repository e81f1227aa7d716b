"""Find the plants among the inputs of `bake`: a folder of scans is one plant."""

import os
from collections.abc import Sequence
from pathlib import Path

from baker.errors import InputError, input_errors
from baker.scans.find import find_scans, holds_scans, require_exists
from baker.scans.rgbd.camera import find_camera
from baker.scans.times.schedule import natural_key


def find_plants(inputs: Sequence[Path], output: str) -> dict[str, Path]:
    """Find the plants to bake, folders by name; none if the inputs are the scans of one plant.

    Several folders are one plant each, and so are the folders in a folder without scans. The folder
    of the clips, which a pattern such as */ may include, is not a plant.

    output: the argument of -o, "" if nothing is written. Raises InputError for files among folders,
    or two plants of one name.
    """
    folders = [path for path in inputs if path.is_dir()]
    if not folders:
        return {}
    for path in inputs:
        require_exists(path)
        if not path.is_dir():
            raise InputError(
                f"'{path}' is a file and '{folders[0]}' a folder: give folders, a plant each (*/ "
                "names folders only), or only the files of one plant's scans."
            )
    if len(folders) == 1:
        if not _may_be_plant(folders[0]):
            folders = _plants_in(folders[0])
        elif not (output.endswith(("/", os.sep)) or (output and Path(output).is_dir())):
            return {}
    clips, plants = Path(output), dict[str, Path]()
    for folder in folders:
        if clips.exists() and folder.samefile(clips):
            continue
        name = Path(os.path.abspath(folder)).name
        if (earlier := plants.setdefault(name, folder)) is not folder:
            raise InputError(
                f"'{earlier}' and '{folder}' would both be {name}.gclip; rename one, or bake them "
                "into different folders."
            )
    return plants


def _may_be_plant(folder: Path) -> bool:
    """Whether a folder holds scans or images of a plant, or can't be read."""
    try:
        return find_camera(folder) is not None or holds_scans(folder)
    except InputError:  # the bake of this folder will fail and say why
        return True


def _plants_in(parent: Path) -> list[Path]:
    """The folders of plants in a folder, in natural order of their names; InputError if none is."""
    with input_errors(parent):
        folders = [path for path in parent.iterdir() if path.is_dir()]
    folders = [path for path in folders if not path.name.startswith(".") and _may_be_plant(path)]
    if not folders:
        find_scans([parent])  # raises an InputError that says what is missing
    return sorted(folders, key=lambda path: natural_key(path.name))
