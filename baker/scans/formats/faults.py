"""What is wrong with a file: said once by the readers, with the file's name by the registry."""

from __future__ import annotations

import math


class FormatError(Exception):
    """What is wrong with a file, in words that follow its name: "holds no points."

    `line` is where in a text it is wrong, from 1.
    """

    def __init__(self, sentence: str, line: int | None = None) -> None:
        super().__init__(sentence)
        self.line = line

    def about(self, name: object) -> str:
        """The whole sentence about the file of that name."""
        place = "" if self.line is None else f", line {self.line}:"
        return f"'{name}'{place} {self}"


def require_room(count: int, size: float, room: int) -> None:
    """FormatError unless `room` bytes can hold `count` points of at least `size` bytes each.

    To be called before memory is made for as many points as a header announces.
    """
    if count <= 0:
        raise FormatError("holds no points.")
    if count * size > room:
        raise FormatError(
            f"is cut short, or its header is wrong: it announces {count} points "
            f"(at least {math.ceil(count * size)} bytes), but {max(room, 0)} bytes follow."
        )


def require_count(announced: int, found: int, what: str = "points") -> None:
    """FormatError unless as many points were found as a header announces."""
    if found != announced:
        raise FormatError(
            f"is cut short, or its header is wrong: it announces {announced} points, but {found} "
            f"{what} follow."
        )
