"""Find the files of a series of scans."""

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from baker.errors import InputError, excerpt, input_errors
from baker.scans.formats import KNOWN, READERS, require_known, suffix_of
from baker.scans.times.schedule import names_without_times, natural_key

# Files that are often in a folder of point clouds: stems of text files, and readers of other files.
NOT_SCANS = {"readme", "license", "licence", "copying", "notice", "changelog", "citation", "traits"}
SECONDARY_READERS = {"mesh", "arrays"}
IMAGES = {".png", ".jpg", ".jpeg", ".tif", ".tiff"}


def find_scans(inputs: Sequence[Path], times_file: Path | None = None) -> tuple[Path, ...]:
    """Find the files of a series: those of one folder, in natural order, or a list of files.

    In a folder, hidden files, sub-folders, files of unknown suffix and texts such as README.txt are
    ignored; so are meshes and arrays where there are two or more point clouds, and files without a
    number in their names beside numbered ones of another suffix.

    times_file: lists the scans and their times. Without it, the names in a folder must show that
    its files are one series. Raises InputError if a path does not exist or is not a scan, or there
    are fewer than two scans.
    """
    if not inputs:
        raise InputError("No scans given: name a folder of scans, or the scans' files in order.")
    for path in inputs:
        require_exists(path)
    if len(inputs) == 1 and inputs[0].is_dir():
        return _find_in_folder(inputs[0], times_file)
    for path in inputs:
        _require_file(path)
        require_known(path)
    path, times = Counter(map(Path.resolve, inputs)).most_common(1)[0]
    if times > 1:
        raise InputError(f"'{path}' is given twice.")
    if len(inputs) == 1:
        raise InputError(f"'{path}' is only one scan; growth needs at least two.")
    return tuple(inputs)


def require_exists(path: Path) -> None:
    """Raise InputError unless the file or folder exists and may be accessed."""
    with input_errors(path):
        path.stat()


def holds_scans(folder: Path) -> bool:
    """Whether `folder` itself, not a folder in it, holds at least one scan."""
    with input_errors(folder):
        return any(_is_named_as_scan(path) and path.is_file() for path in folder.iterdir())


def _find_in_folder(folder: Path, times_file: Path | None) -> tuple[Path, ...]:
    with input_errors(folder):
        entries = sorted(folder.iterdir(), key=lambda path: natural_key(path.name))
        scans = [path for path in entries if _is_named_as_scan(path) and not path.is_dir()]
        for path in scans:
            _require_file(path)
        clouds = [path for path in scans if READERS[suffix_of(path)] not in SECONDARY_READERS]
        scans = clouds if len(clouds) > 1 else scans
        usual, count = Counter(map(suffix_of, scans)).most_common(1)[0] if scans else ("", 0)
        if count > 1 and all(_is_numbered(path) for path in scans if suffix_of(path) == usual):
            scans = [path for path in scans if suffix_of(path) == usual or _is_numbered(path)]
        if times_file is not None and times_file.exists():
            scans = [path for path in scans if not path.samefile(times_file)]
    if len(scans) < 2:
        raise InputError(f"'{folder}' holds {_describe(folder, entries, scans)}.")
    if times_file is None:
        _require_one_series(folder, scans)
    return tuple(scans)


def _require_file(path: Path) -> None:
    require_exists(path)  # a link may refer to a file that is not there
    if not path.is_file():
        raise InputError(f"'{path}' is {'a folder, ' * path.is_dir()}not a regular file.")


def _describe(folder: Path, entries: Sequence[Path], scans: Sequence[Path]) -> str:
    """Describe a folder of fewer than two scans for an error message, with advice."""
    suffixes = {suffix_of(path) for path in entries if path.is_file()}
    if not scans and suffixes & IMAGES:
        needed = "at least fx, fy, cx and cy, in pixels"
        return f"images, but no camera.toml (or camera.json), which needs {needed}"
    description, example = "no scans", folder / "*" / "*.ply"
    if scans:
        description = f"only one scan, '{scans[0].name}'; growth needs at least two"
        example = folder.parent / "*" / scans[0].name
    unread = ", ".join(sorted(suffixes - {*READERS, ""}))
    if unread and not any(path.is_dir() for path in entries):
        advice = "export point clouds as PLY, LAS or E57, meshes as PLY, OBJ or GLB"
        return f"{description}; {excerpt(unread)} can't be read: {advice} (known are {KNOWN})"
    return f"{description} (known are {KNOWN}); name those in several folders, as in bake {example}"


def _is_named_as_scan(path: Path) -> bool:
    is_known = suffix_of(path) in READERS and path.stem.lower() not in NOT_SCANS
    return is_known and not path.name.startswith(".")


def _is_numbered(path: Path) -> bool:
    return re.search(r"\d", path.stem) is not None


def _require_one_series(folder: Path, scans: Sequence[Path]) -> None:
    """Raise InputError where suffixes differ, or names differ in more than a time or a counter.

    Names without times that are all different (seedling.ply, young.ply) are one series.
    """
    names = names_without_times([scan.stem for scan in scans])
    have_times = all(name != scan.stem for name, scan in zip(names, scans, strict=True))
    patterns = [re.sub(r"\d+", "#", name) for name in names]
    groupings = ((list(map(suffix_of, scans)), False), (names, True), (patterns, not have_times))
    for kinds, may_all_differ in groupings:
        count = len(set(kinds))
        if count > 1 and not (may_all_differ and count == len(scans)):
            odd = scans[next(i for i, kind in enumerate(kinds) if kind != kinds[0])]
            remark = "" if _is_numbered(odd) else ", which names no day"
            raise InputError(
                f"'{folder}' seems to hold more than one series ('{scans[0].name}' and "
                f"'{odd.name}'{remark}); give each its own folder, or name the files of one."
            )
