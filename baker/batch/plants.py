"""Which plants a user means: a folder of scans is one plant."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from baker.errors import InputError, asking
from baker.scans.find import find_scans, holds_scans, require_there
from baker.scans.rgbd.camera import find_camera
from baker.scans.times import natural_key


@dataclass(frozen=True)
class Plant:
    """name: the folder's own, and that of the clip; folder: where its scans lie."""

    name: str
    folder: Path


def find_plants(inputs: Sequence[Path], output: str) -> tuple[Plant, ...]:
    """The plants to bake into the folder `output`, in the order given; none where the inputs are
    the scans of one plant, to be baked into one clip.

    Several folders are a plant each; so are the folders in a folder that holds no scans itself.
    The folder of the clips is no plant, though a pattern such as */ may name it. Without an output,
    nothing is required of one.

    Raises InputError: files among folders, two plants of one name, or an output that doesn't fit.
    """
    folders = [path for path in inputs if path.is_dir()]
    if not folders:
        if names_folder(output) and inputs:
            find_scans(inputs)
            raise InputError(
                f"-o {output} is a folder, but the files are scans of one plant: name its clip, "
                f"such as {Path(output) / 'plant.gclip'}."
            )
        return ()
    for path in inputs:
        require_there(path)
        if not path.is_dir():
            raise InputError(
                f"'{path}' is a file and '{folders[0]}' a folder: give folders, a plant each (*/ "
                "names folders only), or only the files of one plant's scans."
            )
    many = folders
    if len(folders) == 1 and not _is_plant(folders[0]):
        many = _plants_below(folders[0])
        if not many:
            find_scans(folders)  # says what is missing
    elif len(folders) == 1 and not names_folder(output):
        return ()
    if output:
        _require_folder(output, len(many))
    clips = Path(output)
    many = [path for path in many if not (clips.exists() and path.samefile(clips))]
    plants = tuple(Plant(Path(os.path.abspath(path)).name, path) for path in many)
    _require_distinct(plants)
    return plants


def names_folder(output: str) -> bool:
    """Whether -o means a folder: one that is there, or a name that ends as a folder's does."""
    return bool(output) and (output.endswith(("/", os.sep)) or Path(output).is_dir())


def _is_plant(folder: Path) -> bool:
    return find_camera(folder) is not None or holds_scans(folder)


def _may_be_plant(folder: Path) -> bool:
    """A folder that can't be read is one, whose bake fails and says why; the others' don't."""
    try:
        return _is_plant(folder)
    except InputError:
        return True


def _plants_below(greenhouse: Path) -> list[Path]:
    with asking(greenhouse):
        below = [path for path in greenhouse.iterdir() if path.is_dir()]
    below = [path for path in below if not path.name.startswith(".") and _may_be_plant(path)]
    return sorted(below, key=lambda path: natural_key(path.name))


def _require_folder(output: str, plants: int) -> None:
    if names_folder(output):
        return
    folder = Path(output).with_suffix("")
    if Path(output).exists():
        raise InputError(f"-o {output} is a file; the clips of {plants} plants need a folder.")
    if Path(output).suffix == ".gclip":
        raise InputError(
            f"-o {output} is one clip's name, but these are {plants} plants, a clip each: name a "
            f"folder for them, such as {folder}/."
        )
    raise InputError(f"-o {output}: there is no such folder; {output}/ has it made.")


def _require_distinct(plants: Sequence[Plant]) -> None:
    seen: dict[str, Plant] = {}
    for plant in plants:
        if not plant.name:
            raise InputError(f"'{plant.folder}' has no name that its clip could have.")
        earlier = seen.setdefault(plant.name, plant)
        if earlier is not plant:
            raise InputError(
                f"'{earlier.folder}' and '{plant.folder}' would both be {plant.name}.gclip; "
                "rename one, or bake them into different folders."
            )
