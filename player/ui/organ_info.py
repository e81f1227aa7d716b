"""Facts about a picked organ, with its traits once they are measured."""

from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from gclip import Clip
from player.view.colors import format_number
from traits.curves import TraitCurve, trait_curves
from traits.dates import date_at


class OrganInfo:
    """Measures organs of one clip in a thread, so that the window never waits.

    measuring: set to true when curves are requested that are not available yet.
    """

    def __init__(self, clip: Clip) -> None:
        self._clip, self._pool = clip, ThreadPoolExecutor(1)
        self._curves: dict[int, Future[list[TraitCurve]]] = {}
        self.measuring = False

    def release(self) -> None:
        self._pool.shutdown(wait=False, cancel_futures=True)

    def curves(self, track: int) -> tuple[TraitCurve, ...]:
        """The organ's traits over time; empty until they are measured."""
        if track not in self._curves:  # organs picked in passing need not be measured
            self._curves = {other: f for other, f in self._curves.items() if not f.cancel()}
            self._curves[track] = self._pool.submit(trait_curves, self._clip, [track])
        future = self._curves[track]
        self.measuring |= not future.done()
        succeeded = future.done() and not future.cancelled() and future.exception() is None
        return tuple(future.result()) if succeeded else ()

    def lines(self, clip: Clip, track: int, day: float) -> list[tuple[str, str]]:
        """Facts about an organ on a day as (label, value).

        clip: the same clip with the current names of organs; track: index in its track table.
        """
        organ = clip.track_table[track]
        facts = [("kind", organ.kind)] if organ.kind not in ("organ", "") else []
        if organ.parent is not None:
            facts.append(("grows from", clip.track_table[organ.parent].name))
        is_first = organ.born <= clip.times[0]
        born = "before the first scan" if is_first else date_at(clip.scans, organ.born)
        facts.append(("born", born))
        if organ.lost is not None:
            facts.append(("lost", date_at(clip.scans, organ.lost)))
        if not is_first and day >= organ.born and clip.time_unit == "days":
            facts.append(("age", f"{day - organ.born:.1f} days"))
        curves = [curve for curve in self.curves(track) if curve.trait in ("length", "area")]
        return facts + [(f"{curve.trait} now", _value_at(curve, day)) for curve in curves]


def _value_at(curve: TraitCurve, day: float) -> str:
    """Format the value on a day, interpolated linearly between scans as in the plot."""
    if not curve.times[0] <= day <= curve.times[-1]:
        return "not there"
    value = np.interp(day, curve.times, curve.values)
    sure = np.interp(day, curve.times, curve.sure) == 1.0  # at both scans
    return f"{'' if sure else 'about '}{format_number(float(value), 4)}{curve.unit}"
