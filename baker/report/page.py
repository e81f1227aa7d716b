"""The report's page: everything gathered, laid out by the template, written in one step."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from math import ceil, floor
from pathlib import Path
from typing import Any

from baker.options import Options
from baker.pipeline import Survey
from baker.report.pictures import (
    MAX_DOUBTS_PICTURED,
    NoPicture,
    round_length,
    scans_pictured,
    take_pictures,
)
from baker.report.verification import HoldoutError, overall
from baker.verdict.doubt import between, command_for, doubts_in, grouped, headline
from gclip import Clip
from gclip.terminal.atomic import atomic_file, writing
from gclip.text import printable
from traits.curves import TraitCurve, plotted, trait_curves

MAX_TICKS = 5  # of the growth curves' axis, above 0
MAX_CURVES = 40  # of the largest organs: nobody could tell more lines apart


def write_report(
    path: str | os.PathLike[str],
    clip: Clip,
    record: Survey,
    errors: Sequence[HoldoutError],
    *,
    title: str = "growth clip",
    workers: int = 0,
    report_progress: Callable[[str, int, int], None] = lambda stage, done, total: None,
) -> None:
    """Write the report of a bake, one self-contained HTML file; whole or not at all.

    Parameters
    ----------
    path : path-like
    clip, record
        As `bake_recorded` returns them.
    errors : sequence of HoldoutError
        Of `verify`.
    title : str
        What the page is called: the clip's name.
    workers : int
        Cores to use; 0 takes all.
    report_progress : callable, optional
        Called with a stage's name, the steps done and the steps in all.

    Raises
    ------
    UserError
        Where the file can't be written. Where the player can't draw, the report says so.
    """
    title, doubts = printable(title), doubts_in(clip)  # the name of a file need not be UTF-8
    by_interval = grouped(doubts)
    report_progress("report", 0, 1)
    with writing(Path(path)), atomic_file(Path(path)) as part:
        pictures, no_pictures = None, ""
        with ThreadPoolExecutor(1) as beside:  # the players are processes of their own
            measured = beside.submit(trait_curves, clip, largest_organs(clip))
            try:
                pictures = take_pictures(clip, by_interval, part.parent, workers)
            except NoPicture as error:
                no_pictures = str(error)
        found = measured.result()
        curves = {trait: [one for one in found if one.trait == trait] for trait in plotted(clip)}
        page = _template().render(
            title=title,
            clip=clip,
            record=record,
            headline=headline(clip, doubts),
            doubts=[(between(clip, own[0]), own) for own in by_interval],
            command=partial(command_for, path=title),
            pictures=pictures,
            pictured=MAX_DOUBTS_PICTURED,
            no_pictures=no_pictures,
            shown=scans_pictured(clip),
            curves=curves["length"],
            charts=[
                (trait, sorted(own, key=lambda one: -one.values[-1]), ticks(own))
                for trait, own in curves.items()
                if trait not in ("area", "angle")
            ],
            errors=errors,
            overall=overall(errors) if errors else None,
            defaults=Options().provenance(),
            dates_of={scan.time: scan.date for scan in clip.scans},
            zip=zip,
            colors={track.id: "#" + bytes(track.color).hex() for track in clip.track_table},
        )
        part.write_bytes(page.encode())
    report_progress("report", 1, 1)


def largest_organs(clip: Clip) -> list[int]:
    """Track ids of the organs whose curves are drawn: those of the most points."""
    sizes = dict.fromkeys(range(len(clip.track_table)), 0)
    for pair in (pair for interval in clip.intervals for pair in interval.segments):
        sizes[pair.track] = max(sizes[pair.track], pair.start_points, pair.end_points)
    return sorted(sorted(sizes, key=lambda track: -sizes[track])[:MAX_CURVES])


def ticks(curves: Sequence[TraitCurve]) -> list[float]:
    """Round values below and above all of some curves, for the axis of their chart."""
    low = min((curve.bottom for curve in curves), default=0.0)
    high = max((curve.top for curve in curves), default=1.0)
    high = high if high > low else low + (abs(low) or 1.0)
    step = round_length(2.5 * (high - low) / MAX_TICKS)  # rounding may more than halve it
    return [step * k for k in range(floor(low / step), ceil(high / step) + 1)]


def _template() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("baker.report"), autoescape=True, undefined=StrictUndefined
    )
    environment.trim_blocks = environment.lstrip_blocks = True
    environment.filters.update(significant=_significant, sentence=_sentence)
    return environment.get_template("report.html.j2")


def _significant(number: float) -> str:
    """A number as people read it: three digits that matter, no more."""
    return f"{number:,.0f}" if abs(number) >= 1000 else f"{number:.3g}"


def _sentence(note: str) -> str:
    """A note with a capital letter before it and a full stop after it."""
    return note[:1].upper() + note[1:] + ("" if note.endswith((".", "!", "?")) else ".")
