"""pyproject.toml names the libraries that the packages import, no more and no fewer."""

from __future__ import annotations

import ast
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text())
PACKAGES = SETTINGS["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
FOR_DEVELOPERS = {"docs", "fuzz", "test"}  # extras; of the others a user chooses


def imported() -> set[str]:
    """Distributions whose modules the packages import, wherever in a file."""
    names: set[str] = set()
    for path in (path for package in PACKAGES for path in (ROOT / package).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module.partition(".")[0])
    foreign = names - sys.stdlib_module_names - set(PACKAGES)
    distributions = packages_distributions()
    return {canonicalize_name(distributions[name][0]) for name in foreign}


def named(requirements: list[str]) -> set[str]:
    """Distributions that are required on this platform."""
    parsed = [Requirement(requirement) for requirement in requirements]
    return {canonicalize_name(r.name) for r in parsed if r.marker is None or r.marker.evaluate()}


def test_what_is_imported_is_required_and_the_other_way_round() -> None:
    project = SETTINGS["project"]
    optional = project["optional-dependencies"]
    extras = [line for name in optional if name not in FOR_DEVELOPERS for line in optional[name]]
    assert imported() - named(extras) == named(project["dependencies"])
    assert named(extras) <= imported()
