"""Which files are the scans."""

import re
from collections import Counter
from collections.abc import Sequence
from itertools import islice
from pathlib import Path

from baker.errors import InputError, asking, excerpt
from baker.scans.formats import KNOWN, READERS, require_known, suffix_of
from baker.scans.times.schedule import names_without_times, natural_key

# Stems of texts, and readers of files, that often lie beside point clouds.
NOT_SCANS = {"readme", "license", "licence", "copying", "notice", "changelog", "citation", "traits"}
BESIDE_SCANS = {"mesh", "arrays"}
MAX_SEARCHED = 10_000  # entries below a folder without scans, for one to name
IMAGES = {".png", ".jpg", ".jpeg", ".tif", ".tiff"}


def find_scans(inputs: Sequence[Path], times_file: Path | None = None) -> tuple[Path, ...]:
    """Find the files of a series: those of one folder, in natural order, or a list of files.

    In a folder, hidden files, sub-folders, files of unknown suffix and texts such as README.txt are
    passed over; beside point clouds, so are meshes and arrays. Where a file lists the times of the
    scans, and so what belongs together, names may be any. InputError unless there are two or more.
    """
    if not inputs:
        raise InputError("No scans given: name a folder of scans, or the scans' files in order.")
    for path in inputs:
        require_there(path)
    if len(inputs) == 1 and inputs[0].is_dir():
        return _in_folder(inputs[0], times_file)

    seen: dict[Path, Path] = {}
    for path in inputs:
        if not path.is_file():
            kind = "a folder: give one folder alone, or only the files of the scans"
            raise InputError(f"'{path}' is {kind if path.is_dir() else 'not a regular file'}.")
        require_known(path)
        earlier = seen.setdefault(path.resolve(), path)
        if earlier is not path:
            raise InputError(f"'{earlier}' is given twice (again as '{path}').")
    if len(inputs) == 1:
        raise InputError(f"'{inputs[0]}' is only one scan; growth needs at least two.")
    return tuple(inputs)


def require_there(path: Path) -> None:
    """InputError unless there is such a file or folder, and it may be looked at."""
    with asking(path):
        if not path.exists():
            raise InputError(f"'{path}': there is no such file or folder.")


def holds_scans(folder: Path) -> bool:
    """Whether `folder` itself holds a scan, be they enough for a series or not."""
    with asking(folder):
        return any(_is_scan(path) for path in folder.iterdir())


def _in_folder(folder: Path, times_file: Path | None) -> tuple[Path, ...]:
    with asking(folder):
        entries = sorted(folder.iterdir(), key=lambda path: natural_key(path.name))
        for path in entries:
            if _is_named_as_scan(path) and not (path.is_file() or path.is_dir()):
                link = "a link to a file that is not there"
                raise InputError(f"'{path}' is {link if path.is_symlink() else 'no regular file'}.")
        scans = [path for path in entries if _is_scan(path)]
        clouds = [path for path in scans if READERS[suffix_of(path)] not in BESIDE_SCANS]
        scans = clouds if len(clouds) > 1 else scans
        if times_file is not None and times_file.exists():
            scans = [path for path in scans if not path.samefile(times_file)]
    if not scans:
        raise InputError(f"'{folder}' holds {_instead_of_scans(folder, entries)}")
    if len(scans) == 1:
        one = f"only one scan, '{scans[0].name}'; growth needs at least two"
        example = folder.parent / "*" / scans[0].name
        beside = f"; name those in several folders, as in bake {example}"
        raise InputError(f"'{folder}' holds {one}{_unknown(entries) or beside}.")
    if times_file is None:
        _require_one_series(folder, scans)
    return tuple(scans)


def _instead_of_scans(folder: Path, entries: Sequence[Path]) -> str:
    if any(path.suffix.lower() in IMAGES for path in entries):
        return (
            "images, but no camera.toml (or camera.json) that says how the camera sees; it needs "
            "at least fx, fy, cx and cy, in pixels."
        )
    below = "; folders in it are not searched" if any(p.is_dir() for p in entries) else ""
    if deeper := next(filter(_is_scan, islice(folder.rglob("*"), MAX_SEARCHED)), None):
        *above, name = deeper.relative_to(folder).parts
        example = Path(folder, *("*" for _ in above), name)
        return f"no scans{below}: name them, as in bake {example}"
    return f"no scans{below}{_unknown(entries) or f'; known are {KNOWN}'}."


def _unknown(entries: Sequence[Path]) -> str:
    """What lies in a folder that can't be read, and what to export instead."""
    files = [path for path in entries if path.is_file() and suffix_of(path) not in READERS]
    kinds = Counter(path.suffix.lower() for path in files if path.suffix)
    if not kinds:
        return ""
    listed = [f"{n} {excerpt(kind)} file{'s' * (n > 1)}" for kind, n in kinds.most_common(3)]
    return (
        f"; it holds {', '.join(listed)}, which can't be read: export point clouds as PLY, LAS or "
        f"E57, meshes as PLY, OBJ or GLB (known are {KNOWN})"
    )


def _is_scan(path: Path) -> bool:
    return _is_named_as_scan(path) and path.is_file()


def _is_named_as_scan(path: Path) -> bool:
    is_known = suffix_of(path) in READERS and path.stem.lower() not in NOT_SCANS
    return is_known and not path.name.startswith(".")


def _require_one_series(folder: Path, scans: Sequence[Path]) -> None:
    """Refuse a mix of suffixes, or of names that differ in more than a time or a counter.

    Names without times that have nothing in common (seedling.ply, young.ply) are one series.
    """
    names = names_without_times([scan.stem for scan in scans])
    have_times = all(name != scan.stem for name, scan in zip(names, scans, strict=True))
    patterns = [re.sub(r"\d+", "#", name) for name in names]
    tries = ((list(map(suffix_of, scans)), False), (names, True), (patterns, not have_times))
    for kinds, may_all_differ in tries:
        count = len(set(kinds))
        if count > 1 and not (may_all_differ and count == len(scans)):
            other = next(i for i, kind in enumerate(kinds) if kind != kinds[0])
            raise InputError(
                f"'{folder}' seems to hold more than one series ('{scans[0].name}' and "
                f"'{scans[other].name}'); give each its own folder, or name the files of one."
            )
