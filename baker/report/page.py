"""The report's page: everything gathered, laid out by the templates, written in one step."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from baker.errors import writing
from baker.options import Options, worker_count
from baker.pipeline import BakeRecord
from baker.report.errormap import ErrorScale
from baker.report.figures import interval_figures, picture_requests, scan_figures
from baker.report.organs import organs_of_scans
from baker.report.pictures import NoPicture, Picture, take_pictures
from baker.report.verification import HoldoutError, overall, verify
from gclip import Clip
from gclip.terminal.atomic import atomic_file


def write_report(
    path: str | os.PathLike[str],
    clip: Clip,
    record: BakeRecord,
    *,
    title: str = "growth clip",
    errors: Sequence[HoldoutError] | None = None,
    seconds: Mapping[str, float] | None = None,
    workers: int = 0,
    report_progress: Callable[[str, int, int], None] = lambda stage, done, total: None,
) -> None:
    """Write the report of a bake, one self-contained HTML file; whole or not at all.

    Where the player can't draw (no EGL), the report says so in place of the pictures.

    Parameters
    ----------
    path : path-like
    clip, record
        As `bake_recorded` returns them.
    title : str
        What the page is called, for example the clip's name.
    errors : sequence of HoldoutError, optional
        Of `verify`, where scans were left out. By default they are found out here.
    seconds : mapping of str to float, optional
        The stages' durations, for the timing table.
    workers : int
        Pictures drawn at a time, 0 for as many as there are cores.
    report_progress : callable, optional
        Called with a stage's name, the steps done and the steps in all.

    Raises
    ------
    InputError
        Where the file can't be written.
    """
    found = verify(clip, record, report_progress) if errors is None else errors
    organs = organs_of_scans(record)
    scale = ErrorScale.of(found) if found else None
    requests = picture_requests(clip, record, organs, found, scale)
    with writing(Path(path)), atomic_file(Path(path)) as part:
        pictures: dict[str, Picture] = {}
        no_pictures = ""
        try:
            pictures = take_pictures(
                requests,
                clip,
                worker_count(workers),
                partial(report_progress, "pictures"),
                part.parent,
            )
        except NoPicture as error:
            no_pictures = str(error)
        report_progress("report", 0, 1)
        intervals = interval_figures(clip, record, organs)
        page = _template().render(
            title=title,
            clip=clip,
            record=record,
            pictures=pictures,
            no_pictures=no_pictures,
            scans=scan_figures(record, organs, intervals, pictures),
            intervals=intervals,
            errors=found,
            overall=overall(found) if found else None,
            scale=scale,
            seconds=seconds or {},
            defaults=Options().provenance(),
            notes=_notes(record),
            names={track.id: track.name for track in clip.track_table},
            tags=_tags(clip),
            colors={track.id: "#" + bytes(track.color).hex() for track in clip.track_table},
            inks={track.id: _ink(*track.color) for track in clip.track_table},
        )
        part.write_bytes(page.encode())
    report_progress("report", 1, 1)


def _template() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("baker.report"), autoescape=True, undefined=StrictUndefined
    )
    environment.trim_blocks = environment.lstrip_blocks = True
    environment.filters.update(significant=_significant, sentence=_sentence, tiny=_tiny)
    environment.filters["largest"] = lambda table: max(table.values())
    return environment.get_template("report.html.j2")


def _significant(number: float) -> str:
    """A number as people read it: three digits that matter, no more."""
    return f"{number:,.0f}" if abs(number) >= 1000 else f"{number:.3g}"


def _tiny(number: float) -> str:
    """An error that may be nothing but rounding."""
    return "0" if number == 0 else "< 1e-12" if number < 1e-12 else f"{number:.2g}"


def _sentence(note: str) -> str:
    """A note with a capital letter before it and a full stop after it."""
    return note[:1].upper() + note[1:] + ("" if note.endswith((".", "!", "?")) else ".")


def _tags(clip: Clip) -> dict[int, str]:
    """A number for each organ: the one its name ends in where these differ, else its id."""
    ends = {track.id: re.search(r"\d+$", track.name) for track in clip.track_table}
    numbers = {organ: end[0] for organ, end in ends.items() if end is not None}
    distinct = len(set(numbers.values())) == len(ends)
    return numbers if distinct else {organ: str(organ) for organ in ends}


def _notes(record: BakeRecord) -> dict[str, str]:
    """What reading and segmenting found, and in which scans; said once where it is the same."""
    found: dict[str, list[str]] = {}
    segmented = zip(record.series.scans, record.hierarchies, strict=True)
    origins = [(scan.name, scan.notes) for scan in record.found.scans]
    for name, notes in origins + [(scan.name, hierarchy.notes) for scan, hierarchy in segmented]:
        for note in notes:
            found.setdefault(note, []).append(name)
    return {
        note: "all scans" if len(names) == len(record.found.scans) else ", ".join(names)
        for note, names in found.items()
    }


def _ink(red: int, green: int, blue: int) -> str:
    """Black or white, whichever is easier to read on a colour (its luma, ITU-R BT.601)."""
    return "#111" if 0.299 * red + 0.587 * green + 0.114 * blue > 140 else "#fff"
