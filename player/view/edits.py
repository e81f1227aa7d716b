"""What people put right about organs in the window. Loads nothing: the table of keys needs it."""

from dataclasses import dataclass, replace
from typing import Self

from gclip.corrections import Correction

BETWEEN = {"same": "is", "different": "is not"}


@dataclass(frozen=True)
class Edits:
    """The corrections of a clip's organs, as they are, were before, and were before an undo.

    baked: those that the clip was baked with.
    """

    now: tuple[Correction, ...] = ()
    baked: tuple[Correction, ...] = ()
    past: tuple[tuple[Correction, ...], ...] = ()
    future: tuple[tuple[Correction, ...], ...] = ()

    @property
    def is_baked(self) -> bool:
        """Whether the clip shows what they say; new names it shows at once."""
        shown = [one for one in self.now if one.kind != "name" or one in self.baked]
        return sorted(map(str, shown)) == sorted(map(str, self.baked))

    def changed(self, now: tuple[Correction, ...]) -> Self:
        return replace(self, now=now, past=(*self.past, self.now), future=())

    def undone(self) -> Self:
        if not self.past:
            return self
        future = (*self.future, self.now)
        return replace(self, now=self.past[-1], past=self.past[:-1], future=future)

    def redone(self) -> Self:
        if not self.future:
            return self
        return replace(self.changed(self.future[-1]), future=self.future[:-1])


def sentence(correction: Correction) -> str:
    """A correction in a few words."""
    first, last = correction.places[0].organ, correction.places[-1].organ
    if correction.kind == "name":
        return f"{first} is called {correction.name}"
    if correction.kind == "different" and first == last:
        return f"{first} is two organs"
    return (
        f"{first} is cut"
        if correction.kind == "cut"
        else (f"{first} {BETWEEN[correction.kind]} {last}")
    )
