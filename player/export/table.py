"""The traits of the plant and its organs, as a table (see `traits`)."""

from pathlib import Path

import traits
from gclip import Clip
from player.export.film import Film, Progress


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Measure on the film's days where it names some, else at the scans and half way between."""
    named = film.at or film.every is not None
    days = sorted(set(film.days(clip))) if named else traits.measure_days(clip)
    with path.open("w", encoding="utf-8", newline="") as file:
        traits.write_table(file, traits.NamedPlant(clip, film.title or film.name), days, progress)
