"""The alignment of a series, kept too: nothing else of a bake takes as long but its intervals."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.alignment import Alignment, PairFit, align
from baker.alignment.register import Progress
from baker.batch.cache.digest import digest, program_digest
from baker.batch.cache.intervals import IntervalCache
from baker.geometry.parallel import MapLike
from gclip.terminal.atomic import atomic_file


def aligned(
    cache: IntervalCache | None,
    clouds: Sequence[NDArray[np.float32]],
    method: str,
    up: str,
    root: NDArray[np.floating] | None,
    progress: Progress | None = None,
    map: MapLike = map,
) -> Alignment:
    """What `align` finds for these arguments, or what it found for the same ones earlier."""
    if cache is None:
        return align(clouds, method, up, root, progress, map)
    name = digest(program_digest(), "alignment", list(clouds), method, up, root)
    path = cache.folder / name[:2] / f"{name}.json"
    found = _read(path, name)
    if found is None:
        found = align(clouds, method, up, root, progress, map)
        try:
            _write(path, name, found)
        except OSError as error:
            cache.trouble = cache.trouble or f"{path} can't be written: {error.strerror or error}"
    return found


def _write(path: Path, name: str, alignment: Alignment) -> None:
    entry = {
        "alignment": name,
        "up": alignment.up,
        "transforms": [transform.tolist() for transform in alignment.transforms],
        "drift": [asdict(fit) for fit in alignment.drift],
        "notes": list(alignment.notes),
    }
    path.parent.mkdir(exist_ok=True)
    with atomic_file(path) as part:
        part.write_text(json.dumps([entry, _checksum(entry)]), "utf-8")


def _read(path: Path, name: str) -> Alignment | None:
    """None where it is not there, or not whole."""
    try:
        if not path.is_file():
            return None
        entry, checksum = json.loads(path.read_text("utf-8"))
        if checksum != _checksum(entry) or entry["alignment"] != name:
            return None
        return Alignment(
            up=entry["up"],
            transforms=tuple(np.array(rows, np.float64) for rows in entry["transforms"]),
            drift=tuple(PairFit(**fit) for fit in entry["drift"]),
            notes=tuple(entry["notes"]),
        )
    except (OSError, ValueError, TypeError, LookupError, RecursionError):
        return None


def _checksum(entry: object) -> str:
    return hashlib.sha256(json.dumps(entry, sort_keys=True).encode()).hexdigest()
