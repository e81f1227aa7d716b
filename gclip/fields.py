"""Reading a clip's JSON document without trusting it: bounded in size, strict in every field."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from gclip.errors import ClipError
from gclip.text import printable

LARGEST = 1e18  # of any number: its square is still a float32, which is what a GPU calculates with
LONGEST_TEXT = 1000  # characters of a name
DEEPEST = 32  # objects and lists within each other, where a field may hold anything
SPARE = 64 << 20  # bytes that reading a file may take up beyond twice its size
T = TypeVar("T")


def parse(text: str, file_size: int) -> Fields:
    """The object that a document holds.

    file_size: bytes of the file that it comes from; a document whose values would take up much more
               is refused before it is read.
    Raises ClipError for what is not JSON as RFC 8259 has it, says a field twice, or is too much.
    """
    if footprint(text) > SPARE + 2 * file_size:
        raise ClipError("its document holds far more values than a file of its size needs")
    try:
        found = json.loads(
            text, object_pairs_hook=_unique, parse_constant=_refused, parse_float=_finite
        )
    except json.JSONDecodeError as error:
        reason = f"{error.msg[:1].lower()}{error.msg[1:]} at character {error.pos}"
        raise ClipError(f"its document is not valid JSON: {reason}") from None
    except RecursionError:
        raise ClipError("its document is not valid JSON: it is nested too deeply") from None
    except ValueError:
        raise ClipError("its document is not valid JSON: a number has too many digits") from None
    return Fields(found)


def footprint(text: str) -> int:
    """Bytes of memory, at most, that the values in a JSON text take up once they are read.

    Objects, lists, their entries and names are counted by what begins or parts them; what one takes
    up at most was measured, the data model's own objects included.
    """
    costs = {"{": 300, "[": 80, ",": 88, ":": 210}
    return 2 * sys.getsizeof(text) + sum(text.count(c) * cost for c, cost in costs.items())


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ClipError("its document says the same field twice")
    return found


def _refused(constant: str) -> Any:
    raise ClipError(f"its document is not valid JSON: it holds {constant}")


def _finite(digits: str) -> float:
    value = float(digits)
    if math.isinf(value):
        raise ClipError(f"its document holds {digits[:20]}, more than a number can be")
    return value


@dataclass(frozen=True, slots=True)
class Fields:
    """A JSON object whose fields are read by type; a wrong one is a ClipError naming its place.

    place: where it stands in the document, "" for the document itself.
    Text comes without control characters.
    """

    value: Any
    place: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.value, dict):
            raise ClipError(f"{self.place or 'its document'} is not an object")

    def at(self, key: str) -> str:
        """The place of a field."""
        return f"{self.place}.{key}" if self.place else key

    def present(self, key: str) -> bool:
        return self.value.get(key) is not None

    def text(self, key: str, default: str | None = None) -> str:
        value = self._get(key, lambda v: isinstance(v, str), "text", default)
        if len(value) > LONGEST_TEXT:
            raise ClipError(
                f"{self.at(key)} is {len(value)} characters long; {LONGEST_TEXT} are allowed"
            )
        return printable(value)

    def number(self, key: str, default: float | None = None, lowest: float = -LARGEST) -> float:
        value = self._get(key, _is_number, _NUMBER, default)
        if value < lowest:
            raise ClipError(f"{self.at(key)} is {value:g}; at least {lowest:g} is needed")
        return float(value)

    def optional_number(self, key: str) -> float | None:
        return self.number(key) if self.present(key) else None

    def count(self, key: str) -> int:
        return self._get(key, _is_count, "a whole number from 0", None)

    def optional_count(self, key: str) -> int | None:
        return self.count(key) if self.present(key) else None

    def vector(
        self, key: str, default: tuple[float, float, float] | None = None
    ) -> tuple[float, float, float]:
        value = self._get(
            key,
            lambda v: isinstance(v, list | tuple) and len(v) == 3 and all(map(_is_number, v)),
            f"three times {_NUMBER}",
            default,
        )
        return float(value[0]), float(value[1]), float(value[2])

    def one_of(self, key: str, allowed: tuple[str, ...], default: str | None = None) -> str:
        value = self.text(key, default)
        if value not in allowed:
            raise ClipError(f'{self.at(key)} is "{value[:30]}"; one of {", ".join(allowed)}')
        return value

    def items(self, key: str, optional: bool = False) -> list[Any]:
        default: list[Any] | None = [] if optional else None
        return self._get(key, lambda v: isinstance(v, list), "a list", default)

    def texts(self, key: str) -> tuple[str, ...]:
        """A list of text, empty where there is none."""
        items = self.items(key, optional=True)
        if not all(isinstance(item, str) for item in items):
            raise ClipError(f"{self.at(key)} holds something else than text")
        return tuple(printable(item, LONGEST_TEXT) for item in items)

    def object(self, key: str) -> Fields:
        return Fields(self.value.get(key), self.at(key))

    def objects(self, key: str, optional: bool = False) -> list[Fields]:
        items = self.items(key, optional)
        return [Fields(item, f"{self.at(key)}[{i}]") for i, item in enumerate(items)]

    def anything(self, key: str) -> dict[str, Any]:
        """An object that may hold whatever JSON can say, within reason; empty where there is none.

        Its texts come without control characters.
        """
        value = self._get(key, lambda v: isinstance(v, dict), "an object", {})
        return _cleaned(value, self.at(key), DEEPEST)

    def _get(self, key: str, accept: Callable[[Any], bool], what: str, default: T | None) -> Any:
        value = self.value.get(key, default)
        if value is None or not accept(value):
            found = "missing" if key not in self.value else _shown(value)
            raise ClipError(f"{self.at(key)} is {found}; {what} is needed")
        return value


_NUMBER = f"a number up to {LARGEST:g}"


def _shown(value: Any) -> str:
    if isinstance(value, dict | list):
        return "an object" if isinstance(value, dict) else "a list"
    return repr(value[:40]) if isinstance(value, str) else str(value)[:40]


def _is_number(value: Any) -> bool:
    plain = isinstance(value, int | float) and not isinstance(value, bool)
    return plain and -LARGEST <= value <= LARGEST


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**48


def _cleaned(value: Any, place: str, deeper: int) -> Any:
    if deeper < 0:
        raise ClipError(f"{place} is nested more than {DEEPEST} levels deep")
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, list):
        return [_cleaned(item, place, deeper - 1) for item in value]
    if isinstance(value, dict):
        return {printable(k): _cleaned(item, place, deeper - 1) for k, item in value.items()}
    return value
