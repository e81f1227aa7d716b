"""What is known of a picked organ: from the clip at once, its length as soon as it is measured."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from gclip.errors import ClipError
from player.view.dates import date_at

if TYPE_CHECKING:
    from gclip import Clip
    from traits import Measurement

PAUSE = 0.7  # seconds between measurements while time goes on


class OrganFacts:
    """Measures organs in a thread; the window never waits for it."""

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._thread: threading.Thread | None = None
        self._asked: tuple[int, float] | None = None
        self._found: tuple[tuple[int, float], Measurement | None] | None = None
        self._ended = 0.0

    @property
    def busy(self) -> bool:
        """Whether an answer is on its way."""
        return self._thread is not None and self._thread.is_alive()

    def lines(self, track: int, day: float) -> list[tuple[str, str]]:
        """(what, value) pairs about an organ on a day, for people; the length may be of a moment
        ago while the plant grows.
        """
        clip, organ = self._clip, self._clip.track_table[track]
        self._ask(track, day)
        facts = [("kind", organ.kind)] if organ.kind not in ("organ", "") else []
        if organ.parent is not None:
            facts.append(("grows from", clip.track_table[organ.parent].name))
        seen = organ.born <= clip.times[0]
        facts.append(("born", "before the first scan" if seen else date_at(clip.scans, organ.born)))
        if organ.lost is not None:
            facts.append(("lost", date_at(clip.scans, organ.lost)))
        if not seen and day >= organ.born and clip.time_unit == "days":
            facts.append(("age", f"{day - organ.born:.1f} days"))
        if self._found is not None and self._found[0][0] == track:
            facts += self._measured(self._found[1])
        return facts

    def _measured(self, found: Measurement | None) -> list[tuple[str, str]]:
        if found is None:
            return [("length now", "not there")]
        unit = self._clip.unit or "units"
        values = [("length", found.length, unit), ("area", found.area, f"{unit}²")]
        return [
            (f"{name} now", f"{'' if name in found.sure else 'about '}{value:.4g} {of}")
            for name, value, of in values
            if value is not None
        ]

    def _ask(self, track: int, day: float) -> None:
        new = self._asked is None or self._asked[0] != track
        if self._asked == (track, day) or self.busy:
            return
        if not new and time.monotonic() < self._ended + PAUSE:
            return
        self._asked = (track, day)
        self._thread = threading.Thread(target=self._measure, args=self._asked, daemon=True)
        self._thread.start()

    def _measure(self, track: int, day: float) -> None:
        from traits import measure

        with suppress(ClipError):  # cut short while it is open: who draws it tells
            found = measure(self._clip, day, only=[track])
            self._found = ((track, day), found[0] if found else None)
        self._ended = time.monotonic()
