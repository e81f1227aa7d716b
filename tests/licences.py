"""Licences of all packages that an installation brings: `python -m tests.licences [EXTRA ...]`.

Prints a line a package: name, version, licence as its metadata have it.
"""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterable
from contextlib import suppress
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]


def installed(extras: Iterable[str] = ()) -> dict[str, Distribution]:
    """The project's packages by name, those of its extras too, and all that these need."""
    found: dict[str, Distribution] = {}
    seen: set[tuple[str, frozenset[str]]] = set()

    def add(lines: Iterable[str], extras: frozenset[str]) -> None:
        for one in map(Requirement, lines):
            own = frozenset(one.extras)
            is_asked = any(not one.marker or one.marker.evaluate({"extra": e}) for e in extras)
            if not is_asked or (one.name, own) in seen:
                continue
            seen.add((one.name, own))
            with suppress(PackageNotFoundError):  # of an extra that isn't installed
                package = found.setdefault(canonicalize_name(one.name), distribution(one.name))
                add(package.requires or (), own | {""})

    add(PROJECT["dependencies"], frozenset({""}))
    for extra in extras:
        add(PROJECT["optional-dependencies"][extra], frozenset({""}))
    return found


def licence(package: Distribution) -> str:
    """By the expression, else the classifiers, else the first line of the text."""
    told = package.metadata
    classifiers = [one for one in told.get_all("Classifier") or () if one.startswith("License ::")]
    names = "; ".join(one.rpartition(" :: ")[2] for one in classifiers)
    first_line = (told.get("License") or "").strip().partition("\n")[0]
    return told.get("License-Expression") or names or first_line or "not told"


if __name__ == "__main__":
    for name, package in sorted(installed(sys.argv[1:]).items()):
        print(f"{name:<28} {package.version:<16} {licence(package)}")
