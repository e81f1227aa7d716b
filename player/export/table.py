"""Export of the traits of the plant and its organs as a table (see `traits`)."""

from pathlib import Path

import traits
from gclip import Clip
from player.export.film import Film, Progress


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Measure on the film's days, by default at the scans and in the middle between them."""
    has_days = film.at or film.every is not None
    days = sorted(set(film.days(clip))) if has_days else traits.measure_days(clip)
    with path.open("w", encoding="utf-8", newline="") as file:
        traits.write_table(file, traits.NamedPlant(clip, film.title or film.name), days, progress)
