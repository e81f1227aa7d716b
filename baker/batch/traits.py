"""`bake --traits`: what the plant and its organs measure, as a table (see `measure`)."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gclip import Clip


def write_traits(
    path: Path, clip: Clip, plant: str, progress: Callable[[str, int, int], None]
) -> None:
    """Measure at the scans and half way between; whole or not at all.

    plant: what the table calls it. Raises InputError where the file can't be written.
    """
    from baker.report.page import write_whole
    from traits import measure_days, write_table
    from traits.table import Namer

    table = io.StringIO()
    write_table(
        table,
        Namer(clip, plant),
        measure_days(clip),
        lambda done, total: progress("measuring", done, total),
    )
    write_whole(path, table.getvalue())
