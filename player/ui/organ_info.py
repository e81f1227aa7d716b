"""What is known of a picked organ: its traits as soon as they are measured."""

from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from gclip import Clip
from player.view.dates import date_at
from traits.curves import TraitCurve, trait_curves


class OrganInfo:
    """Measures organs of one clip in a thread; the window never waits for it.

    measuring: set once curves are asked for that are not known yet.
    """

    def __init__(self, clip: Clip) -> None:
        self._clip, self._pool = clip, ThreadPoolExecutor(1)
        self._curves: dict[int, Future[list[TraitCurve]]] = {}
        self.measuring = False

    def release(self) -> None:
        self._pool.shutdown(wait=False, cancel_futures=True)

    def curves(self, track: int) -> tuple[TraitCurve, ...]:
        """The organ's traits over time; none until they are measured."""
        if track not in self._curves:
            self._curves[track] = self._pool.submit(trait_curves, self._clip, [track])
        found = self._curves[track]
        self.measuring |= not found.done()
        known = found.done() and not found.cancelled() and found.exception() is None
        return tuple(found.result()) if known else ()

    def lines(self, clip: Clip, track: int, day: float) -> list[tuple[str, str]]:
        """What to tell about an organ, by its row in the clip's table, on a day: (what, value).

        clip: the same one, whose organs may have other names by now.
        """
        organ = clip.track_table[track]
        facts = [("kind", organ.kind)] if organ.kind not in ("organ", "") else []
        if organ.parent is not None:
            facts.append(("grows from", clip.track_table[organ.parent].name))
        seen = organ.born <= clip.times[0]
        facts.append(("born", "before the first scan" if seen else date_at(clip.scans, organ.born)))
        if organ.lost is not None:
            facts.append(("lost", date_at(clip.scans, organ.lost)))
        if not seen and day >= organ.born and clip.time_unit == "days":
            facts.append(("age", f"{day - organ.born:.1f} days"))
        told = [curve for curve in self.curves(track) if curve.trait in ("length", "area")]
        return facts + [(f"{curve.trait} now", _value_at(curve, day)) for curve in told]


def _value_at(curve: TraitCurve, day: float) -> str:
    """The value on a day, as the plot above the timeline has it: linear between the scans."""
    if not curve.times[0] <= day <= curve.times[-1]:
        return "not there"
    value = np.interp(day, curve.times, curve.values)
    sure = np.interp(day, curve.times, curve.sure) == 1.0  # at both scans
    return f"{'' if sure else 'about '}{value:.4g}{curve.unit}"
