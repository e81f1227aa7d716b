"""Read configuration files (TOML, JSON) of limited size and validate them with msgspec."""

import re
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

import msgspec
from msgspec import DecodeError, ValidationError

from gclip.errors import UserError
from gclip.text import printable

T = TypeVar("T")


def read_text(path: Path, most: int) -> str:
    """Read a UTF-8 file of at most `most` bytes. Raises UserError, which names the file."""
    try:
        if path.exists() and not path.is_file():
            raise UserError(f"'{path}' is not a regular file.")
        if (size := path.stat().st_size) > most:
            raise UserError(f"'{path}' holds {size:,} bytes; at most {most:,} are allowed.")
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UserError(f"'{path}' can't be read: {error.strerror or error}.") from None
    except UnicodeDecodeError:
        raise UserError(f"'{path}' is not a text file.") from None


def read_config(path: Path, kind: type[T], most: int) -> T:
    """Read a TOML file, or a JSON file if its suffix is .json.

    Parameters
    ----------
    path : Path
    kind : type
        The msgspec type to which the content is converted.
    most : int
        The largest size, in bytes.

    Raises
    ------
    UserError
        Names the file, the field, its value and what is needed.
    """
    text = read_text(path, most)
    content: Any = None
    try:
        content = (msgspec.json if path.suffix.lower() == ".json" else msgspec.toml).decode(text)
        return msgspec.convert(content, kind)
    except ValidationError as error:  # "what is wrong - at `$.table[0].field`"
        reason, _, place = str(error).rpartition(" - at `$")
        reason, field = (reason, place.strip(".`")) if reason else (place, "")
        with suppress(LookupError, TypeError):  # the name of a field may contain [0] itself
            for index, name in re.findall(r"\[(\d+)\]|(\w+)", field):
                content = content[int(index) if index else name]
        numbered = re.sub(r"\[(\d+)\]", lambda index: f" {int(index[1]) + 1}", field)
        found = f"{numbered} is {printable(repr(content), 80)}; " if field else ""
        raise UserError(f"'{path}': {found}{printable(reason, 120)}.") from None
    except (DecodeError, RecursionError, ValueError) as error:  # a number of 5,000 digits
        raise UserError(f"'{path}' is not valid {path.suffix[1:].upper()}: {error}.") from None
