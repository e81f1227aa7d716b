"""Whether a clip is what a bake would give: then it needs no baking."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from baker.options import Options
    from gclip import Clip


def standing_clip(path: Path, folder: Path, options: Options) -> Clip | None:
    """The clip at `path` if it is whole and what `folder` gives with these options, else None.

    The clip itself says what it was made of. It stands if the program and its packages have the
    same versions, the options are the same, and so are the scans, by the digest of their bytes,
    their names, order and times.

    Raises InputError where the folder holds no series of scans.
    """
    import gclip

    try:
        clip = gclip.open(path)
    except gclip.ClipError:
        return None
    return clip if _made_of(clip, folder, options) else None


def _made_of(clip: Clip, folder: Path, options: Options) -> bool:
    from baker.batch.provenance import software
    from baker.scans.read import list_series
    from baker.scans.stage import read_options, told_by
    from baker.scans.unchanged import digest

    chosen = read_options(options)
    listing = list_series([folder], chosen)
    told = told_by(listing.series((), chosen), options)
    entries = listing.schedule.entries
    expected = {**software(), "options": told.provenance()}
    if any(clip.provenance.get(key) != _as_json(value) for key, value in expected.items()):
        return False
    moments = {entry.name: (entry.moment.time, entry.moment.date) for entry in entries}
    if any(moments.get(scan.name) != (scan.time, scan.date) for scan in clip.scans):
        return False
    made = clip.provenance.get("inputs")
    if not isinstance(made, list) or len(made) != len(entries):
        return False
    # Digests last: they read every scan.
    return all(
        scan == {"name": entry.name, "sha256": digest(listing.files(entry))}
        for scan, entry in zip(made, entries, strict=True)
    )


def _as_json(value: object) -> object:
    """As it reads once it has been written: tuples as lists."""
    return json.loads(json.dumps(value))
