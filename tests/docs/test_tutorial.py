"""The tutorial notebook runs from beginning to end, and shows what it says.

Its plant has fewer points, its pictures and films fewer pixels than in print.
"""

from __future__ import annotations

import json
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

ROOT = Path(__file__).parents[2]
TUTORIAL = ROOT / "docs/tutorial.ipynb"
SMALLER = {'"3000"': '"1000"', "(480, 360)": "(160, 120)"}  # points of a scan; pictures, films


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[dict]]:
    """What each cell of code puts out, by its text."""
    folder = tmp_path_factory.mktemp("tutorial")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(ROOT))
        notebook = nbformat.read(TUTORIAL, as_version=4)
        for cell in notebook.cells:
            for printed, smaller in SMALLER.items():
                cell.source = cell.source.replace(printed, smaller)
        resources = {"metadata": {"path": str(folder)}}
        done = NotebookClient(notebook, timeout=300, resources=resources).execute()
    assert (folder / "film.mp4").stat().st_size > 10_000
    assert (folder / "plant.gclip").exists()
    return {cell.source: cell.outputs for cell in done.cells if cell.cell_type == "code"}


def test_the_clip_shows_itself_as_its_page(outputs: dict[str, list[dict]]) -> None:
    (shown,) = outputs["clip"]
    html = shown["data"]["text/html"]
    assert html.startswith("<iframe srcdoc=")
    assert "https://" not in html
    assert shown["data"]["text/plain"].startswith("<gclip.Clip: 5 scans")


def test_pictures_and_the_table_are_shown(outputs: dict[str, list[dict]]) -> None:
    every = [output for cell in outputs.values() for output in cell]
    kinds = [kind for output in every for kind in output.get("data", {})]
    assert kinds.count("image/png") == 2
    (table,) = outputs["table = clip.traits()\ntable.query(\"trait == 'length'\").head()"]
    assert "organ" in table["data"]["text/html"]


def test_the_notebook_is_kept_without_outputs() -> None:
    """They would be stale, large, and tell of the machine that made them."""
    cells = json.loads(TUTORIAL.read_text("utf-8"))["cells"]
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells)
