"""What users choose among, and put right. Loads nothing: `--help` reads the table of keys."""

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Self

from corrections import Correction

SIZES: tuple[tuple[int, int] | None, ...] = (
    None,
    (1280, 720),
    (1920, 1080),
    (3840, 2160),
    (1080, 1080),
    (1080, 1920),
)


class Compare(StrEnum):
    """What is seen besides the plant at the present day."""

    OFF = "off"
    WIPE = "wipe"
    BESIDE = "side by side"


class Wish(StrEnum):
    """What the window is to do once, when the next picture is drawn."""

    PICTURE = "save a picture of what is seen"
    EXPORT = "begin an export, or stop the one under way"
    CAMERA_KEY = "add the camera to the path that is kept in a file"


@dataclass(frozen=True)
class Output:
    """What the next picture or export is to be."""

    #: the example of a format in player/export/formats.py, which names it
    example: str = "film.mp4"
    size: tuple[int, int] | None = None  #: (width, height) in pixels, None for the window's own
    transparent: bool = False  #: the plant alone, in PNG pictures


@dataclass(frozen=True)
class Edits:
    """The corrections of a clip's organs: those after each change, and after which of them it is.

    baked: those that the clip was baked with.
    """

    history: tuple[tuple[Correction, ...], ...] = ((),)
    step: int = 0
    baked: tuple[Correction, ...] = ()

    @property
    def now(self) -> tuple[Correction, ...]:
        return self.history[self.step]

    @property
    def is_baked(self) -> bool:
        """Whether the clip shows what they say."""
        return sorted(map(str, self.now)) == sorted(map(str, self.baked))

    def changed(self, now: tuple[Correction, ...]) -> Self:
        done = self.history[: self.step + 1]
        return replace(self, history=(*done, now), step=len(done))

    def moved(self, direction: int) -> Self:
        """Undo the last change (-1), or make it again (1), if there is one."""
        return replace(self, step=min(max(self.step + direction, 0), len(self.history) - 1))


def sentence(correction: Correction) -> str:
    """A correction in a few words."""
    first, last = correction.places[0].organ, correction.places[-1].organ
    match correction.kind:
        case "name":
            return f"{first} is called {correction.name}"
        case "cut":
            return f"{first} is cut"
        case "same":
            return f"{first} is {last}"
    return f"{first} is two organs" if first == last else f"{first} is not {last}"
