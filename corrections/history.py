"""The undo history of corrections, and their descriptions for users."""

from dataclasses import dataclass, replace
from typing import Self

from corrections import Correction


@dataclass(frozen=True)
class Edits:
    """An immutable undo history of the corrections of a clip's organs."""

    history: tuple[tuple[Correction, ...], ...] = ((),)  #: all corrections after each change
    step: int = 0  #: index of the current state in `history`
    baked: tuple[Correction, ...] = ()  #: corrections that the clip was baked with

    @property
    def current(self) -> tuple[Correction, ...]:
        return self.history[self.step]

    @property
    def is_baked(self) -> bool:
        """Whether the clip was baked with the current corrections."""
        return sorted(map(str, self.current)) == sorted(map(str, self.baked))

    def changed(self, corrections: tuple[Correction, ...]) -> Self:
        """Append a state, and forget the states that were undone."""
        past = self.history[: self.step + 1]
        return replace(self, history=(*past, corrections), step=len(past))

    def moved(self, direction: int) -> Self:
        """Undo the last change (-1), or redo the next one (1), if there is one."""
        return replace(self, step=min(max(self.step + direction, 0), len(self.history) - 1))


def describe(correction: Correction) -> str:
    """Describe a correction in a few words, for lists and notices."""
    first, last = correction.places[0].organ, correction.places[-1].organ
    match correction.kind:
        case "name":
            return f"{first} is called {correction.name}"
        case "cut":
            return f"{first} is cut"
        case "same":
            return f"{first} is {last}"
    return f"{first} is two organs" if first == last else f"{first} is not {last}"
