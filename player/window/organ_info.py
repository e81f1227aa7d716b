"""What is known of a picked organ: from the clip at once, its length as soon as it is measured."""

import time
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress

from gclip import Clip
from gclip.errors import ClipError
from player.view.dates import date_at
from traits import Measurement, measure
from traits.curves import TraitCurve, trait_curves

PAUSE = 0.7  # seconds between measurements while time goes on


class OrganInfo:
    """Measures organs of one clip in a thread; the window never waits for it."""

    def __init__(self, clip: Clip) -> None:
        self._clip = clip
        self._pool = ThreadPoolExecutor(1)
        self._running: Future[None] | None = None
        self._asked: tuple[int, float] | None = None
        self._found: tuple[int, Measurement | None] | None = None
        self._ended = 0.0
        self._curves: dict[int, Future[list[TraitCurve]]] = {}

    def release(self) -> None:
        self._pool.shutdown(wait=False, cancel_futures=True)

    def curves(self, track: int) -> tuple[TraitCurve, ...]:
        """The organ's traits over time; none until they are measured."""
        if track not in self._curves:
            self._curves[track] = self._pool.submit(trait_curves, self._clip, [track])
        found = self._curves[track]
        failed = not found.done() or found.cancelled() or found.exception() is not None
        return () if failed else tuple(found.result())

    def lines(self, clip: Clip, track: int, day: float) -> list[tuple[str, str]]:
        """What to tell about an organ, by its row in the clip's table, on a day: (what, value).

        clip: the same one, whose organs may have other names by now.
        The length may be of a moment ago while the plant grows.
        """
        organ = clip.track_table[track]
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
        if self._found is not None and self._found[0] == track:
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
        busy = self._running is not None and not self._running.done()
        same = self._asked is not None and self._asked[0] == track
        soon = same and time.monotonic() < self._ended + PAUSE
        if busy or soon or self._asked == (track, day):
            return
        self._asked = (track, day)
        self._running = self._pool.submit(self._measure, track, day)

    def _measure(self, track: int, day: float) -> None:
        with suppress(ClipError):  # cut short while it is open: who draws it tells
            found = measure(self._clip, day, only=[track])
            self._found = (track, found[0] if found else None)
        self._ended = time.monotonic()
