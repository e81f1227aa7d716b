"""What people put right about organs in the window. Loads nothing: the table of keys needs it."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import msgspec

from gclip.corrections import Correction

if TYPE_CHECKING:
    from gclip import Clip

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
        """Whether the clip shows what they say."""
        return sorted(map(str, self.now)) == sorted(map(str, self.baked))

    def changed(self, now: tuple[Correction, ...]) -> Edits:
        return replace(self, now=now, past=(*self.past, self.now), future=())

    def undone(self) -> Edits:
        if not self.past:
            return self
        future = (*self.future, self.now)
        return replace(self, now=self.past[-1], past=self.past[:-1], future=future)

    def redone(self) -> Edits:
        if not self.future:
            return self
        return replace(self.changed(self.future[-1]), future=self.future[:-1])

    def name_of(self, organ: str) -> str:
        """What an organ will be called, by what the clip calls it."""
        new = [c.name for c in self.now if c not in self.baked and c.places[0].organ == organ]
        return next(filter(None, reversed(new)), organ)


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


def baked_corrections(clip: Clip) -> tuple[Correction, ...]:
    """Those that a clip was baked with; none where it does not say so."""
    with suppress(KeyError, TypeError, msgspec.ValidationError):  # a clip may say anything
        found = clip.provenance["options"]["corrections"]
        return msgspec.convert(found, tuple[Correction, ...])
    return ()
