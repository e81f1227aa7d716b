"""`gclip check`: every byte counts, and what is wrong is named with its place."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from safetensors import safe_open
from safetensors.numpy import save_file

import gclip
from gclip import check
from gclip.cli import main


@pytest.fixture
def saved(make_clip, tmp_path: Path) -> Path:
    path = tmp_path / "c.gclip"
    make_clip(degree=2, colors=True).save(path)
    return path


def wrong(path: Path) -> str:
    """What is wrong with a file, "" where nothing is."""
    try:
        check(path)
    except gclip.ClipError as error:
        return str(error)
    return ""


def document(path: Path) -> dict:
    with safe_open(path, "numpy") as container:
        return json.loads(container.metadata()["gclip"])


def rewritten(path: Path, change) -> Path:
    """The container again, its document changed by hand, its buffers as they were."""
    with safe_open(path, "numpy") as container:
        text = json.loads(container.metadata()["gclip"])
        buffers = {name: container.get_tensor(name) for name in container.offset_keys()}
    change(text, buffers)
    save_file(buffers, path, {"gclip": json.dumps(text)})
    return path


def test_a_whole_clip_is_whole(saved: Path) -> None:
    size = f"{saved.stat().st_size:,} bytes"
    assert check(saved) == f"3 scans, 2 intervals, 12 buffers, {size}, 13 checksums agree"


def test_checksums_are_what_the_format_says(saved: Path) -> None:
    """Verified with nothing of ours, as a stranger would."""
    with safe_open(saved, "numpy") as container:
        text = container.metadata()["gclip"]
        for name in container.offset_keys():
            content = container.get_tensor(name).tobytes()
            assert json.loads(text)["sha256"][name] == hashlib.sha256(content).hexdigest()
    own = json.loads(text)["sha256"]["document"]
    assert own == hashlib.sha256(text.replace(own, "0" * 64).encode()).hexdigest()


def test_every_flipped_bit_is_noticed(saved: Path) -> None:
    """One bit in each of some hundred places: the header, the document, every buffer."""
    content, random = saved.read_bytes(), np.random.default_rng(1)
    header = 8 + int.from_bytes(content[:8], "little")
    places = [
        *range(8),
        *random.integers(8, header, 80),
        *random.integers(header, len(content), 80),
    ]
    for place in (*places, len(content) - 1):
        damaged = bytearray(content)
        damaged[place] ^= 1 << int(random.integers(8))
        saved.write_bytes(damaged)
        # Spaces at the header's end are padding, and mean nothing whichever they are.
        assert wrong(saved) or json.loads(content[8:header]) == _header(damaged)


def _header(content: bytes | bytearray) -> dict:
    length = int.from_bytes(content[:8], "little")
    return json.loads(content[8 : 8 + length])


def test_what_is_wrong_is_named_with_its_place(saved: Path) -> None:
    content = bytearray(saved.read_bytes())
    with safe_open(saved, "numpy") as container:
        sizes = {name: container.get_tensor(name).nbytes for name in container.offset_keys()}
    first = len(content) - sum(sizes.values())
    for name, size in sizes.items():
        if name in ("0001/end", "0000/start_color"):
            content[first + size // 2] ^= 1
        first += size
    saved.write_bytes(content)
    assert gclip.open(saved).times == [0.0, 2.0, 5.0]
    said = "not what its checksums were written for: "
    assert wrong(saved) == f'{said}"0001/end", "0000/start_color"'


def test_what_open_refuses_is_refused(saved: Path) -> None:
    def change(text: dict, buffers: dict) -> None:
        buffers["0000/track"][7] = 99
        del text["sha256"]

    assert "name track 99" in wrong(rewritten(saved, change))


def test_a_document_that_was_edited_is_noticed(saved: Path) -> None:
    def change(text: dict, buffers: dict) -> None:
        text["tracks"][1]["name"] = "other"

    assert wrong(rewritten(saved, change)).endswith('written for: "document"')


def test_a_missing_checksum_is_noticed(saved: Path) -> None:
    def change(text: dict, buffers: dict) -> None:
        del text["sha256"]["0001/track"]

    assert '"0001/track"' in wrong(rewritten(saved, change))


@pytest.mark.parametrize("value", [7, {"document": 7}, ["x"]])
def test_checksums_that_are_none_are_refused(saved: Path, value: object) -> None:
    def change(text: dict, buffers: dict) -> None:
        text["sha256"] = value

    assert wrong(rewritten(saved, change))


def test_old_clips_have_no_checksums_and_are_whole(saved: Path, capsys) -> None:
    def change(text: dict, buffers: dict) -> None:
        del text["sha256"]
        text["version"] = "1.0"

    rewritten(saved, change)
    assert main(["check", str(saved)]) == 0
    assert "no checksums" in capsys.readouterr().out


def test_a_clip_cut_short_is_said_to_be(saved: Path) -> None:
    content = saved.read_bytes()
    for length in (len(content) - 1, 100):
        saved.write_bytes(content[:length])
        assert "cut short or damaged" in wrong(saved)


def test_several_files_one_exit_code(saved: Path, tmp_path: Path, capsys) -> None:
    other = tmp_path / "other.gclip"
    other.write_bytes(saved.read_bytes()[:-5])
    long = "x" * 5_000
    assert main(["check", long, str(other), str(tmp_path / "absent.gclip"), str(saved)]) == 2
    out, err = capsys.readouterr()
    assert "c.gclip: whole; 3 scans, 2 intervals, 12 buffers" in out
    assert "absent.gclip: no such file." in out
    assert f"{long}: it can't be read: File name too long." in out
    assert err == "gclip: 3 of 4 clips are not whole.\n"
    assert main(["check", "-q", str(saved)]) == 0
    assert capsys.readouterr() == ("", "")


def test_what_is_no_clip_at_all(tmp_path: Path, capsys) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    (tmp_path / "empty").touch()
    (tmp_path / "text").write_text("solid plant\n" * 100)
    (tmp_path / "list").write_bytes((5).to_bytes(8, "little") + b"[1,2]")
    for name in ("pipe", "loop", "empty", "text", "list", "."):
        assert main(["check", str(tmp_path / name)]) == 2
        out, err = capsys.readouterr()
        assert out.count("\n") == err.count("\n") == 1
        assert out.endswith(".\n")


def test_help_and_wrong_words(capsys) -> None:
    assert main(["--help"]) == 0
    assert "check" in capsys.readouterr().out
    assert main(["check", "--help"]) == 0
    assert "checksum" in capsys.readouterr().out
    for words in ([], ["chekc"], ["check"], ["check", "--deep", "x"]):
        assert main(words) == 2
        out, err = capsys.readouterr()
        assert (out, err.count("\n")) == ("", 1)


def test_it_runs_as_a_module_and_help_loads_nothing_heavy(saved: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "gclip", "check", str(saved)], capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    probe = (
        "import sys; from gclip.cli import main; main(['--help']); "
        "sys.exit(str({'numpy', 'safetensors'} & set(sys.modules) or ''))"
    )
    helped = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True)
    assert helped.stderr.strip() == ""
