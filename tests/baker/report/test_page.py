"""The report as a whole: everything there, nothing from outside, written whole or not at all."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from baker.cli import main
from baker.report.page import largest_organs, ticks, write_report
from baker.verdict.doubt import verdict_provenance
from gclip import Clip, ClipError
from gclip.errors import UserError
from traits.curves import TraitCurve, trait_curves
from traits.doubts import Doubt
from traits.holdout_error import verify

SECTIONS = ["verdict", "decisions", "plant", "growth", "verification", "made"]  # in this order


class Page(HTMLParser):
    """What a page holds: its ids, its addresses, its text."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.addresses: list[str] = []
        self.tags: list[str] = []
        self.text = ""
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            if name in ("href", "src", "action", "srcset", "poster", "data", "xlink:href"):
                self.addresses.append(value or "")

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.fixture(scope="module")
def report(tmp_path_factory, player_draws) -> Path:
    """Of a bake from the command line, with awkward names: a stem whose second leaf is new."""
    folder = tmp_path_factory.mktemp("report")
    scans = folder / "scans"
    scans.mkdir()
    along = np.linspace(0, 1, 200)[:, None]
    for day in range(5):
        rods = [along * [0, 0, 10], [0, 0, 6] + along * [2.0 + day, 0, 2]]
        rods += [[0, 0, 8] + along * [0, -1.0 * day, 1]] if day >= 2 else []
        rows = [np.column_stack([rod, np.full(200, k + 1)]) for k, rod in enumerate(rods)]
        np.savetxt(scans / f"<b>&amp;day{day}.txt", np.concatenate(rows), fmt="%.4f")
    clip, path = folder / "plant <u>.gclip", folder / "report.html"
    options = ["--align", "none", "--holdout", "2", "--unit", "<script>", "--report", str(path)]
    assert main([str(scans), "-o", str(clip), *options]) == 0
    return path


def test_everything_is_there_and_nothing_comes_from_outside(report):
    html = report.read_text()
    page = Page(html)
    assert [name for name in page.ids if name in SECTIONS] == SECTIONS
    assert len(set(page.ids)) == len(page.ids)
    for address in page.addresses:
        assert address.startswith(("data:image/jpeg;base64,", "#"))
    assert not re.search(r"https?:|url\(|@import|//[a-z]+\.", re.sub(r"base64,[^\"]*", "", html))
    assert html.count("data:image/jpeg") == 3 + 2  # scans; left out
    for words in ("All 2 intervals look right.", "stem", "leaf 2", "day 2", "holdout", "numba"):
        assert words in page.text


def test_the_verdict_comes_first_with_what_is_wrong_and_where(baked, tmp_path, player_draws):
    clip, record = baked
    doubts = [Doubt(2.0, 4.0, 1, "leaf 1 tears", 2.0), Doubt(2.0, 4.0, 2, "leaf 2 tears", 1.0)]
    judged = replace(
        clip, provenance={**clip.provenance, "verdict": verdict_provenance(clip, doubts)}
    )
    write_report(tmp_path / "r.html", judged, record, verify(judged), title="plant.gclip")
    html = (tmp_path / "r.html").read_text()
    text = " ".join(Page(html).text.split())
    places = [
        text.index(words)
        for words in (
            "1 of 2 intervals looks right.",
            "day 2 to 4",
            "Leaf 1 tears.",
            "Leaf 2 tears.",
            "play plant.gclip --day 3",
            "The plant",
        )
    ]
    assert places == sorted(places)
    assert html.count("data:image/jpeg") == 3 + 3 + 2


def test_the_terminal_shows_the_errors_too(write_scans, tmp_path, capsys):
    out = str(tmp_path / "plant.gclip")
    assert main([str(write_scans()), "-o", out, "--align", "none", "--holdout", "2"]) == 0
    shown = capsys.readouterr().err
    for words in (
        "day01.txt",
        "reconstruction to scan",
        "scan to reconstruction",
        "mean",
        "std",
        "max",
    ):
        assert words in shown


def test_what_users_name_is_text_and_never_markup(report):
    page = Page(report.read_text())
    assert "<b>&amp;day2.txt" in page.text
    assert "plant <u>.gclip" in page.text
    assert "script" not in page.tags
    assert "<b>&amp;day" not in report.read_text()
    assert "u" not in page.tags


@pytest.mark.usefixtures("player_draws")
def test_the_report_does_not_change_the_clip(write_scans, tmp_path):
    folder = write_scans()
    clips = [tmp_path / "with.gclip", tmp_path / "without.gclip"]
    more = ["--report", str(tmp_path / "r.html")], []
    for clip, options in zip(clips, more, strict=True):
        assert main([str(folder), "-o", str(clip), "--align", "none", "-q", *options]) == 0
    assert clips[0].read_bytes() == clips[1].read_bytes()


def test_without_opengl_the_report_says_so(baked, tmp_path, player_fails):
    write_report(tmp_path / "r.html", *baked, verify(baked[0]))
    page = Page((tmp_path / "r.html").read_text())
    assert "play: no EGL here." in page.text
    assert "img" not in page.tags
    assert [name for name in page.ids if name in SECTIONS] == SECTIONS


def test_a_clip_whose_name_is_not_utf_8_has_a_report(baked, tmp_path, player_fails):
    write_report(tmp_path / "r.html", *baked, verify(baked[0]), title="pl\udcff.gclip")
    assert "pl\ufffd.gclip" in (tmp_path / "r.html").read_text()


def test_a_report_without_room_for_its_pictures_says_so(baked, tmp_path, monkeypatch):
    def no_room(clip: object, path: Path) -> None:
        raise ClipError(f"{path} can't be written: No space left on device.")

    monkeypatch.setattr(Clip, "save", no_room)
    write_report(tmp_path / "r.html", *baked, verify(baked[0]))
    assert "there is no room for the clip" in Page((tmp_path / "r.html").read_text()).text


def test_a_report_that_cannot_be_written_leaves_nothing(baked, tmp_path, player_fails):
    (tmp_path / "r.html").mkdir()
    before = sorted(tmp_path.iterdir())
    with pytest.raises(UserError, match=r"r\.html can't be written"):
        write_report(tmp_path / "r.html", *baked, verify(baked[0]))
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("report", "words"),
    [("r.pdf", "ends in .html"), ("nowhere/r.html", "No such file"), ("d.html", "is a folder")],
)
def test_reports_are_refused_before_the_work(tmp_path, capsys, report, words):
    (tmp_path / "d.html").mkdir()
    out, target = str(tmp_path / "p.gclip"), str(tmp_path / report)
    assert main([str(tmp_path / "no scans"), "-o", out, "--report", target]) == 2
    assert words in capsys.readouterr().err


LOOK = """<script>
document.title = JSON.stringify({
  fetched: performance.getEntriesByType("resource").map((e) => e.name.slice(0, 30)),
  heights: [...document.querySelectorAll("main > section")].map((s) => [s.id, s.offsetHeight]),
  images: [...document.querySelectorAll("img")].map((i) => i.naturalWidth),
  wide: document.documentElement.scrollWidth,
  seen: innerWidth,
});
</script>"""


@pytest.mark.parametrize("width", [1280, 480])
def test_a_browser_without_a_network_shows_all_of_it(chromium, report, tmp_path, width):
    looked = tmp_path / "looked.html"
    allowed = report.read_text().replace("style-src", "script-src 'unsafe-inline'; style-src")
    looked.write_text(allowed.replace("</body>", LOOK + "</body>"))
    command = [chromium, "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    offline = ["--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={tmp_path / 'profile'}"]
    shown = subprocess.run(
        [*command, *offline, f"--window-size={width},900", looked.as_uri()],
        capture_output=True,
        text=True,
        timeout=120,
    )
    title = re.search(r"<title>(.*?)</title>", shown.stdout)
    assert title, shown.stderr
    seen = json.loads(title[1])
    assert all(name.startswith("data:") for name in seen["fetched"])
    assert [name for name, _ in seen["heights"]] == list(SECTIONS)
    assert all(height > 60 for _, height in seen["heights"])
    assert len(seen["images"]) == 3 + 2
    assert all(size > 0 for size in seen["images"])
    assert seen["wide"] <= seen["seen"], "nothing sticks out sideways"


@pytest.mark.parametrize("longest", [0.004, 0.99, 1.0, 37.0, 2600.0])
def test_ticks_are_round_and_few_and_reach_the_longest(longest):
    values = longest / 2, longest
    found = ticks([TraitCurve(0, "length", "", (0.0, 1.0), values, (0.0, 0.0), (True, True))])
    assert found[0] == 0.0
    assert found[-2] < longest <= found[-1]
    assert 2 <= len(found) <= 7
    assert f"{found[1]:e}"[0] in "125"


def test_the_axis_of_a_field_begins_below_its_lowest_mean() -> None:
    curve = TraitCurve(0, "mean ndvi", "", (0.0, 1.0), (-0.31, 0.28), (0.0, 0.0), (True, True))
    assert ticks([curve]) == pytest.approx([-0.4, -0.2, 0.0, 0.2, 0.4])
    flat = replace(curve, values=(20.0, 20.0))
    assert len(ticks([flat])) > 1


def test_growth_curves_have_a_band_and_are_measured_as_traits_are(
    baked, tmp_path, player_fails, monkeypatch
):
    clip, record = baked
    write_report(tmp_path / "r.html", clip, record, [])
    page = Page((tmp_path / "r.html").read_text())
    assert largest_organs(clip) == list(range(len(clip.track_table)))
    monkeypatch.setattr("baker.report.page.MAX_CURVES", 2)
    assert largest_organs(clip) == [0, 3], "the stem and the leaf of the most points"
    assert page.tags.count("polygon") == page.tags.count("polyline") == len(clip.track_table)
    assert page.tags.count("circle") == sum(
        len(curve.times) for curve in trait_curves(clip) if curve.trait == "length"
    )
