"""Names for contents: the same numbers, the same name, wherever and whenever."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np


def digest(*values: Any) -> str:
    """SHA-256, in hexadecimal digits, over numbers, text, arrays, containers and dataclasses of
    them, with their types, shapes and names of fields.

    Raises TypeError for anything else: what it holds might not be all that it is.
    """
    found = hashlib.sha256()
    _feed(found, values)
    return found.hexdigest()


def _feed(found: Any, value: Any) -> None:
    if is_dataclass(value) and not isinstance(value, type):
        found.update(f"<{type(value).__name__}>".encode())
        for field in fields(value):
            found.update(f"{field.name}:".encode())
            _feed(found, getattr(value, field.name))
    elif isinstance(value, np.ndarray | np.generic):
        array = np.ascontiguousarray(value)
        if array.dtype.hasobject:
            raise TypeError("an array of objects has no digest")
        found.update(f"{array.dtype.str}{np.shape(value)}".encode())
        found.update(array.data)
    elif isinstance(value, Mapping):
        _feed(found, sorted(value.items()))
    elif isinstance(value, tuple | list):
        found.update(f"[{len(value)}]".encode())
        for item in value:
            _feed(found, item)
    elif isinstance(value, str):  # strings that stand for a choice count as what they say
        text = str(value).encode(errors="surrogateescape")
        found.update(f"str{len(text)}:".encode() + text)
    elif value is None or isinstance(value, bool | int):
        found.update(f"{value!r};".encode())
    elif isinstance(value, float):
        found.update(f"{value.hex()};".encode())
    else:
        raise TypeError(f"{type(value).__name__} has no digest")


@cache
def program_digest() -> str:
    """Of all that turns the same scans into the same numbers: our code, the packages, the machine.

    The code itself and not only its version: an old result must not outlive a change.
    """
    import platform

    import baker
    import gclip
    from baker.batch.provenance import software

    sources = {
        f"{package.__name__}/{path.relative_to(root).as_posix()}": path.read_bytes().hex()
        for package in (baker, gclip)
        for root in [Path(str(package.__file__)).parent]
        for path in sorted(root.rglob("*.py"))
    }
    return digest(software(), platform.machine(), sources)
