"""The Dockerfile's own steps, as far as they go without a container.

A build needs a daemon and an hour's traffic; what breaks one when the project changes is here: a
file that is left out of the context, a system library or an extra that has gone.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from importlib.util import find_spec
from pathlib import Path

from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def instructions(path: Path) -> list[tuple[str, str]]:
    """Each instruction's word and what follows, lines that go on joined."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    joined = "\n".join(lines).replace("\\\n", " ")
    pairs = [line.partition(" ") for line in joined.splitlines() if line]
    return [(word, re.sub(r"\s+", " ", rest).strip()) for word, _, rest in pairs]


def runs(path: Path) -> str:
    return " && ".join(rest for word, rest in instructions(path) if word == "RUN")


def copy_context(folder: Path) -> None:
    """What `COPY . /source` copies; .dockerignore leaves out everything but what it names."""
    rules = (ROOT / ".dockerignore").read_text().split("\n")
    assert "*" in rules
    for rule in rules:
        if rule.startswith("!"):
            source, copy = ROOT / rule[1:], folder / rule[1:]
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copytree(source, copy) if source.is_dir() else shutil.copy(source, copy)


def wheel_of(folder: Path, to: Path) -> set[str]:
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(to)]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    with zipfile.ZipFile(next(to.glob("*.whl"))) as archive:
        return set(archive.namelist())


def test_what_is_copied_is_all_that_is_installed(tmp_path: Path) -> None:
    copy_context(tmp_path / "source")
    copied = wheel_of(tmp_path / "source", tmp_path / "copied")
    assert copied == wheel_of(ROOT, tmp_path / "whole")


def test_extras_commands_and_python_are_those_of_the_project() -> None:
    steps = instructions(ROOT / "Dockerfile")
    [extras] = re.findall(r'"/source\[(.*?)\]"', runs(ROOT / "Dockerfile"))
    assert set(extras.split(",")) <= PROJECT["optional-dependencies"].keys()
    [python] = [rest.removeprefix("python:") for word, rest in steps if word == "FROM"]
    assert python.removesuffix("-slim") in SpecifierSet(PROJECT["requires-python"])
    [command] = [rest for word, rest in steps if word == "CMD"]
    assert command.split('"')[1] in PROJECT["scripts"]
    for module in re.findall(r"python -m (\S+)", runs(ROOT / "Dockerfile")):
        assert find_spec(module) is not None


def test_the_libraries_that_run_installs_are_installed() -> None:
    needed = re.search(
        r"missing_packages\(\) \{(.*?)\"\$1\" = test", (ROOT / "run").read_text(), re.S
    )
    assert needed is not None
    libraries = set(re.findall(r"\|\| echo (\S+)", needed[1]))
    assert len(libraries) >= 3
    assert libraries <= set(runs(ROOT / "Dockerfile").split())


def test_the_image_for_kubernetes_finds_what_it_copies(tmp_path: Path) -> None:
    copy_context(tmp_path)
    steps = instructions(ROOT / "docs/examples/Dockerfile")
    assert steps[0] == ("FROM", "plant-growth-clips")
    for word, rest in steps:
        if word == "COPY":
            assert (tmp_path / rest.split()[0]).exists()
