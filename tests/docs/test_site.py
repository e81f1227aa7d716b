"""The site is built without a warning, and its navigation leads to every page."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    for package in ("sphinx", "myst_parser", "furo"):
        pytest.importorskip(package, reason=f"{package} is not installed (pip install '.[docs]')")
    work = tmp_path_factory.mktemp("site")
    shutil.copytree(ROOT / "docs", work / "docs")
    shutil.copy(ROOT / "README.md", work)
    build = [sys.executable, "-m", "sphinx", "-nWq", "--keep-going", "docs", "site"]
    done = subprocess.run(build, cwd=work, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return work / "site"


def test_every_page_is_in_the_navigation(site: Path) -> None:
    first = (site / "index.html").read_text("utf-8")
    for page in (ROOT / "docs").rglob("*.md"):
        name = page.relative_to(ROOT / "docs").with_suffix(".html")
        assert page.stem == "index" or f'href="{name}"' in first


def test_every_option_has_its_place(site: Path) -> None:
    text = (site / "options.html").read_text("utf-8")
    for words in ("--align", "auto|turn|icp|none", "--camera", "--shuffle-labels"):
        assert words in text
    assert "options of" not in text


def test_pictures_come_along_and_nothing_is_fetched(site: Path) -> None:
    first = (site / "index.html").read_text("utf-8")
    for picture in (ROOT / "docs" / "gallery").glob("*.[wjp][epn][bpg]*"):
        assert picture.name in first
        assert list(site.rglob(picture.name))
    for page in site.rglob("*.html"):
        text = page.read_text("utf-8")
        assert not [tag for tag in ('src="http', 'rel="stylesheet" href="http') if tag in text]
