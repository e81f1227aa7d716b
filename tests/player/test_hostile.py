"""What strangers write into clips and scans gives no orders, wherever it is shown."""

from __future__ import annotations

import csv
import html.parser
import json
import re
from dataclasses import replace
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from markupsafe import escape

import gclip
from gclip import Clip
from gclip.errors import UserError
from player.cli import main
from player.export import Film, export
from tests.gclip.hostile import INJECTIONS, hostile
from tests.player.conftest import ClipMaker
from tests.player.uses import USES, overlaid, told

# Lone surrogates get into no clip that is opened: see tests/gclip/test_hostile.py.
TEXTS = [text[:120] for text in INJECTIONS if text not in ("", "\ud800")]
NASTY = [" ".join(TEXTS), "".join(TEXTS[::-1])]
EXPORTED = (".html", ".ply", ".glb", ".png")


def poisoned(clip: Clip, text: str) -> Clip:
    """The clip with a text wherever it holds one."""
    segments = tuple(
        gclip.SegmentPair(0, "match", 1, 1, 1, text, 0.0, 0.0, (text,)) for _ in clip.intervals
    )
    return replace(
        clip,
        unit=text,
        scans=tuple(replace(scan, name=text, date=text) for scan in clip.scans),
        track_table=tuple(replace(track, name=text, kind=text) for track in clip.track_table),
        intervals=tuple(
            replace(interval, segments=(segment,))
            for interval, segment in zip(clip.intervals, segments, strict=True)
        ),
        provenance={text: [text, {"options": text}], "notes": [text], "inputs": text},
    )


@pytest.fixture(params=range(len(NASTY)))
def nasty(request: pytest.FixtureRequest) -> str:
    return NASTY[request.param]


@pytest.fixture
def poisonous(make_clip: ClipMaker, tmp_path: Path, nasty: str) -> Path:
    """A file that went through nothing of ours that could clean it."""
    from safetensors import safe_open
    from safetensors.numpy import save_file

    path = tmp_path / "plant.gclip"
    make_clip().save(path)
    with safe_open(path, "numpy") as container:
        document = json.loads(container.metadata()["gclip"])
        buffers = {name: container.get_tensor(name) for name in container.offset_keys()}
    document["unit"] = nasty
    document["provenance"] = {nasty: [nasty, {"options": nasty}], "notes": [nasty]}
    for scan in document["scans"]:
        scan |= {"name": nasty, "date": nasty}
    for track in document["tracks"]:
        track |= {"name": nasty, "kind": nasty}
    save_file(buffers, path, {"gclip": json.dumps(document)})
    return path


def test_the_terminal_shows_names_and_obeys_none(
    poisonous: Path, nasty: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(poisonous), "--info"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert all(c.isprintable() or c == "\n" for c in out)
    assert "\u202e" not in out
    assert "[bold]x[/bold][/]" in out, "as it is, markup and all"
    told(gclip.open(poisonous), poisonous)


class _Elements(html.parser.HTMLParser):
    """What a browser would make of a page: its elements and their attributes."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[str, tuple[str, ...]]] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, tuple(name for name, _ in attributes)))


def elements(page: str) -> list[tuple[str, tuple[str, ...]]]:
    parser = _Elements()
    parser.feed(page)
    return parser.found


def test_the_page_has_no_element_more(make_clip: ClipMaker, tmp_path: Path, nasty: str) -> None:
    export(make_clip(), Film(title="plain"), tmp_path / "plain.html")
    export(poisoned(make_clip(), nasty), Film(title=nasty), tmp_path / "nasty.html")
    plain, page = ((tmp_path / f"{n}.html").read_bytes().decode() for n in ("plain", "nasty"))
    assert elements(page) == elements(plain)
    assert f"<span>{escape(nasty)}</span>" in page, "and the name is all there"
    about = re.search(r'id="clip">(.*?)</script>', page, re.DOTALL)
    assert about is not None
    json.loads(about[1])


def test_tables_hold_no_formulas(make_clip: ClipMaker, tmp_path: Path, nasty: str) -> None:
    clip = poisoned(make_clip(), nasty)
    export(clip, Film(title=nasty, at=(0.0, 2.0)), tmp_path / "traits.csv")
    with (tmp_path / "traits.csv").open(newline="", encoding="utf-8") as f:
        rows = list(csv.reader(f))
    assert len({len(row) for row in rows}) == 1, "no name begins a column or a row"
    for cell in (cell for row in rows for cell in row):
        if cell.startswith(("=", "+", "-", "@", "\t", "\r", "\n")):
            float(cell)  # our own numbers, and nothing else


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "＝", "  =", "-1+1|"])
def test_cells_that_begin_like_a_formula_are_text(
    make_clip: ClipMaker, tmp_path: Path, start: str
) -> None:
    """Also behind blanks, and with the wide forms that spreadsheets take for the narrow ones."""
    name = f"{start}cmd|' /C calc'!A0"
    clip = poisoned(make_clip(), name)
    export(clip, Film(title="x", at=(0.0,)), tmp_path / "traits.csv")
    with (tmp_path / "traits.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    names = {row["organ"] for row in rows} - {""}
    assert names
    assert all(one.startswith("'") for one in names)


def test_point_clouds_keep_their_headers(make_clip: ClipMaker, tmp_path: Path, nasty: str) -> None:
    export(poisoned(make_clip(), nasty), Film(), tmp_path / "cloud.ply")
    header = (tmp_path / "cloud.ply").read_bytes().partition(b"end_header\n")[0].decode("ascii")
    words = [line.split()[0] for line in header.splitlines()]
    assert words[:2] == ["ply", "format"]
    assert [w for w in words[2:] if w != "comment"] == ["element"] + ["property"] * 8


def test_gltf_and_usd_hold_names_as_text(make_clip: ClipMaker, tmp_path: Path, nasty: str) -> None:
    clip = poisoned(make_clip(), nasty)
    export(clip, Film(), tmp_path / "plant.glb")
    content = (tmp_path / "plant.glb").read_bytes()
    length = int.from_bytes(content[12:16], "little")
    document = json.loads(content[20 : 20 + length])
    assert document["nodes"][0]["name"]
    assert '"uri"' not in re.sub(
        r'"name":"(\\.|[^"])*"', "", json.dumps(document, separators=(",", ":"))
    )
    pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Usd

    export(clip, Film(), tmp_path / "plant.usda")
    plain = tmp_path / "plain.usda"
    export(make_clip(), Film(), plain)
    stages = [Usd.Stage.Open(str(path)) for path in (tmp_path / "plant.usda", plain)]
    paths = [[prim.GetPath().pathString for prim in stage.Traverse()] for stage in stages]
    assert paths[0] == paths[1]
    assert all(not s.GetRootLayer().externalReferences for s in stages)


def test_pictures_with_nasty_titles_are_drawn(
    make_clip: ClipMaker, tmp_path: Path, nasty: str
) -> None:
    from player.view.annotations import Annotations
    from player.view.style import Style

    clip = poisoned(make_clip(), nasty)
    film = Film(
        size=(160, 120),
        title=nasty,
        annotations=Annotations(True, True, True),
        style=Style(color_by="track"),
    )
    export(clip, film, tmp_path / "still.png")
    assert (tmp_path / "still.png").stat().st_size > 500


def test_the_window_writes_any_name(make_clip: ClipMaker, nasty: str) -> None:
    overlaid(poisoned(make_clip(), nasty), Path(nasty[:50]))


def test_files_are_named_after_nothing_in_a_clip(tmp_path: Path, nasty: str) -> None:
    from player.output_names import unused_path

    for output in ("film.mp4", "a/%04d.png"):
        path = unused_path(nasty, output, tmp_path)
        assert tmp_path in path.parents
        assert ".." not in path.parts
        assert str(path).isprintable()


@settings(
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(seed=st.integers(0, 2**32), use=st.sampled_from(["evaluated", "told", "loaded"]))
@example(seed=4836, use="told")  # an interval ends where no scan is
def test_whatever_is_opened_can_be_used(seed: int, use: str, tmp_path: Path) -> None:
    path = tmp_path / "x.gclip"
    path.write_bytes(hostile(Random(seed)))
    try:
        clip = gclip.open(path)
    except gclip.ClipError:
        return
    with np.errstate(all="raise", under="ignore"):
        try:
            USES[use](clip, path)
        except UserError as error:
            said = str(error)
        else:
            said = "."
    assert said.endswith(".")


@settings(
    deadline=None,
    max_examples=25,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(seed=st.integers(0, 2**32), suffix=st.sampled_from(EXPORTED))
def test_the_command_says_one_sentence(
    seed: int, suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, output = tmp_path / "x.gclip", tmp_path / f"out{suffix}"
    path.write_bytes(hostile(Random(seed)))
    for other in EXPORTED:
        (tmp_path / f"out{other}").unlink(missing_ok=True)
    small = ["--size", "64x48"] if suffix == ".png" else []
    code = main([str(path), "--export", str(output), "-q", *small])
    said = capsys.readouterr().err
    assert code in (0, 2), said
    assert said.count("\n") == (code == 2)
    assert output.exists() == (code == 0)
    assert sorted(p.name for p in tmp_path.iterdir() if p != output) == ["x.gclip"]
