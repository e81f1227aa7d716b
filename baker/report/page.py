"""The report's page: everything gathered, laid out by the templates, written in one step."""

from __future__ import annotations

import base64
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from baker.errors import InputError
from baker.options import Options, worker_count
from baker.pipeline import BakeRecord
from baker.report.verification import HoldoutError, both_ways, overall, verify
from gclip import Clip
from gclip.terminal.atomic import atomic_file, folder_beside

if TYPE_CHECKING:
    from baker.report.pictures import Picture

Progress = Callable[[str, int, int], None]


def write_report(
    path: str | os.PathLike[str],
    clip: Clip,
    record: BakeRecord,
    *,
    title: str = "",
    errors: Sequence[HoldoutError] | None = None,
    seconds: Mapping[str, float] | None = None,
    workers: int = 0,
    progress: Progress | None = None,
) -> None:
    """Write the report of a bake to `path`, one self-contained HTML file; whole or not at all.

    title:    what the page is called, for example the clip's name.
    errors:   of `verify`, where scans were left out; None has them found out here.
    seconds:  the stages' durations, for the timing table; None leaves it out.
    workers:  pictures drawn at a time, 0 for as many as there are cores.
    progress: called with a stage's name, the steps done and the steps in all.

    Where the player can't draw (no EGL), the report says so in place of the pictures.
    Raises InputError where the file can't be written.
    """
    tell: Progress = progress or (lambda stage, done, total: None)
    found = verify(clip, record, tell) if errors is None else errors
    target = Path(path)
    try:
        with folder_beside(target) as folder:
            page = render_page(clip, record, title, found, seconds, workers, tell, folder)
    except OSError as error:
        raise InputError(f"{target} can't be written: {error.strerror or error}.") from None
    write_whole(target, page)
    tell("report", 1, 1)


def render_page(
    clip: Clip,
    record: BakeRecord,
    title: str,
    errors: Sequence[HoldoutError],
    seconds: Mapping[str, float] | None,
    workers: int,
    tell: Progress,
    folder: Path | None = None,
) -> str:
    """The page's HTML. Pictures are drawn in `folder`, else where the system keeps such files."""
    from baker.report.errormap import common_scale
    from baker.report.figures import (
        Pictures,
        holdout_figures,
        interval_figures,
        scan_figures,
        take_all,
    )
    from baker.report.organs import organs_of_scans
    from baker.report.pictures import NoPicture
    from baker.report.timeline import draw_timeline

    organs = organs_of_scans(record)
    scale = common_scale(errors) if errors else None
    no_pictures = ""
    try:
        pictures = take_all(
            clip,
            record,
            organs,
            errors,
            scale,
            worker_count(workers),
            lambda done, total: tell("pictures", done, total),
            folder,
        )
    except NoPicture as error:
        no_pictures = str(error)
        pictures = Pictures.none(len(organs), len(errors))
    tell("report", 0, 1)
    intervals = interval_figures(clip, record, organs, pictures)
    return _template().render(
        title=title or "growth clip",
        clip=clip,
        record=record,
        no_pictures=no_pictures,
        timeline=draw_timeline(clip, organs),
        scans=scan_figures(clip, record, organs, intervals, pictures),
        intervals=intervals,
        holdouts=holdout_figures(record, errors, scale, pictures),
        overall=overall(list(errors)) if errors else None,
        scale=scale,
        seconds=dict(seconds or {}),
        options=_options(clip.provenance["options"]),
        notes=_notes(record),
        names={track.id: track.name for track in clip.track_table},
        tags=_tags(clip),
        colors={track.id: "#" + bytes(track.color).hex() for track in clip.track_table},
        inks={track.id: _ink(track.color) for track in clip.track_table},
    )


def _template() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("baker.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["significant"] = significant
    environment.filters["sentence"] = sentence
    environment.filters["data_uri"] = data_uri
    environment.filters["tiny"] = tiny
    environment.filters["both_ways"] = both_ways
    return environment.get_template("report.html.j2")


def significant(number: float) -> str:
    """A number as people read it: three digits that matter, no more, thousands apart."""
    return f"{number:,.0f}" if abs(number) >= 1000 else f"{number:.3g}"


def tiny(number: float) -> str:
    """An error that may be nothing but rounding."""
    return "0" if number == 0 else "< 1e-12" if number < 1e-12 else f"{number:.2g}"


def sentence(note: str) -> str:
    """A note with a capital letter before it and a full stop after it."""
    return note[:1].upper() + note[1:] + ("" if note.endswith((".", "!", "?")) else ".")


def data_uri(picture: Picture) -> str:
    """The picture as an address that holds all of it."""
    return "data:image/jpeg;base64," + base64.b64encode(picture.jpeg).decode("ascii")


def _options(chosen: Mapping[str, Any]) -> list[tuple[str, str, bool]]:
    """Name, value and whether it is the default of each option."""
    usual = Options().provenance()
    return [
        (name.replace("_", "-"), "–" if value in (None, "") else str(value), value == usual[name])
        for name, value in chosen.items()
    ]


def _tags(clip: Clip) -> dict[int, str]:
    """A number for each organ: the one its name ends in where that tells all apart, else its id."""
    ends = [re.search(r"\d+$", track.name) for track in clip.track_table]
    numbers = [end[0] for end in ends if end is not None]
    if len(set(numbers)) < len(ends):
        numbers = [str(track.id) for track in clip.track_table]
    return {track.id: number for track, number in zip(clip.track_table, numbers, strict=True)}


def _notes(record: BakeRecord) -> list[tuple[str, str]]:
    """What reading and segmenting found, and in which scans; said once where it is the same."""
    where: dict[str, list[str]] = {}
    for scan in record.found.scans:
        for note in scan.notes:
            where.setdefault(note, []).append(scan.name)
    for scan, hierarchy in zip(record.series.scans, record.hierarchies, strict=True):
        for note in hierarchy.notes:
            where.setdefault(note, []).append(scan.name)
    everywhere = len(record.found.scans)
    return [
        (note, "all scans" if len(names) == everywhere else ", ".join(names))
        for note, names in where.items()
    ]


def _ink(color: tuple[int, int, int]) -> str:
    """Black or white, whichever is easier to read on a colour (its luma, ITU-R BT.601)."""
    luma = 0.299 * color[0] + 0.587 * color[1] + 0.114 * color[2]
    return "#111" if luma > 140 else "#fff"


def write_whole(path: Path, text: str) -> None:
    """Write `text` in one step: a temporary file beside it, then renamed. Raises InputError."""
    write_chunks(path, [text.encode()])


def write_chunks(path: Path, chunks: Iterable[bytes]) -> None:
    """The same for what is too much to hold at once."""
    try:
        with atomic_file(path) as part, part.open("wb") as file:
            file.writelines(chunks)
    except OSError as error:
        raise InputError(f"{path} can't be written: {error.strerror or error}.") from None
