"""What a disk, a user or another program does to a bake: one sentence, nothing lost, no litter."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from baker import InputError, Options
from baker.cli import main
from baker.interpolation.interval_job import solve_intervals
from baker.pipeline import bake_with_survey
from tests.baker.conftest import write_las

LIGHT = ("--paths", "straight")  # a clip that is smaller than its report
PLAIN = Options(align="none", up="z", workers=1)
LIMITED = """
import os, resource, sys
from baker.cli import main
import baker.pipeline, safetensors.numpy, rich.console
import {modules}
{limit}
sys.exit(main(sys.argv[1:]))
"""


linux_only = pytest.mark.skipif(sys.platform != "linux", reason="capabilities are Linux's")


def one_sentence(text: str, *words: str) -> bool:
    lines = text.strip().splitlines()
    return len(lines) == 1 and lines[0].startswith("bake: ") and all(w in lines[0] for w in words)


def listing(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else b"folder"
        for path in sorted(folder.rglob("*"))
    }


@pytest.fixture
def output(tmp_path) -> Path:
    """A clip's name in a folder that holds an older file of that name."""
    folder = tmp_path / "out"
    folder.mkdir()
    for name in ("plant.gclip", "report.html", "traits.csv"):
        (folder / name).write_text("old")
    return folder / "plant.gclip"


def limited(limit: str, *arguments: object) -> subprocess.CompletedProcess:
    """`bake` in a process that has limited itself."""
    code = LIMITED.format(limit=limit, modules="baker.report.page, traits.plants, traits.table")
    words = [*map(str, arguments), "-q", "--align", "none", "--force"]
    # Its limits hold for what Python keeps of modules, too: that would be cut short for good.
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-c", code, *words]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)


def test_a_scan_that_vanishes_is_named(write_scans):
    folder = write_scans()

    def take_away(stage: str, done: int, total: int) -> None:
        if stage == "reading" and done == 1:
            (folder / "day01.txt").unlink(missing_ok=True)

    with pytest.raises(InputError, match=r"day01\.txt' can't be read: No such file"):
        bake_with_survey([folder], PLAIN, take_away)


@pytest.mark.parametrize("harm", ["grows", "is cut", "breaks", "goes"])
def test_a_scan_that_changes_while_it_is_read_is_named(write_scans, monkeypatch, harm):
    from baker.scans import read

    load = read.read_columns

    def load_and_change(path, *more):
        if path.name != "day01.txt":
            return load(path, *more)
        if harm == "breaks":
            path.write_text("1 2 3 0\n4 5")
            return load(path, *more)
        columns = load(path, *more)
        text = path.read_text()
        if harm == "goes":
            path.unlink()
        else:
            path.write_text(text + "0 0 0 0\n" if harm == "grows" else text[:-9])
        return columns

    monkeypatch.setattr(read, "read_columns", load_and_change)
    said = "can't be read" if harm == "goes" else "changed while it was read"
    with pytest.raises(InputError, match=rf"day01\.txt' {said}"):
        bake_with_survey([write_scans()], PLAIN)


@pytest.mark.parametrize("also", [[], ["report"], ["traits"]], ids=["clip", "report", "traits"])
def test_an_output_folder_that_goes_is_said(write_scans, output, monkeypatch, capsys, also):
    def solve_and_remove(*arguments, **named):
        found = list(solve_intervals(*arguments, **named))
        shutil.rmtree(output.parent)
        return found

    monkeypatch.setattr("baker.pipeline.solve_intervals", solve_and_remove)
    options = {"report": ["--report", output.parent / "r.html"]}
    options["traits"] = ["--traits", output.parent / "t.csv"]
    arguments = [
        write_scans(),
        "-o",
        output,
        "-q",
        "--force",
        *[x for name in also for x in options[name]],
    ]
    assert main([str(argument) for argument in arguments]) == 2
    assert one_sentence(capsys.readouterr().err, "can't be written", "No such file")
    assert not output.parent.exists()


@pytest.mark.parametrize(
    ("size", "failing"), [(2_000, "plant.gclip"), (10_000, "report.html")], ids=["clip", "report"]
)
def test_a_full_disk_is_said_and_the_old_file_stays(write_scans, output, size, failing):
    """A process may be held to files of some size: to it, the disk is full."""
    limit = f"resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, {size}))"
    report = output.with_name("report.html")
    done = limited(limit, write_scans(), "-o", output, "--report", report, *LIGHT, "--voxel", "1")
    assert done.returncode == 2, done.stderr
    assert one_sentence(done.stderr, failing, "can't be written", "too large")
    left = listing(output.parent)
    assert set(left) == {"plant.gclip", "report.html", "traits.csv"}
    assert left[failing] == b"old"


def test_a_disk_that_is_really_full(write_scans, tmp_path):
    """One of 64 kB; where none may be mounted, files may be no larger than that."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(disk)]
    mounted = shutil.which("mount") and not subprocess.run(mount, capture_output=True).returncode
    limit = "" if mounted else "resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))"
    try:
        (disk / "plant.gclip").write_text("old")
        kept = [write_scans(), "-o", disk / "plant.gclip", "--cache", disk / "cache"]
        done = limited(limit, *kept, "--precision", "float32")
        why = "No space left on device" if mounted else "too large"
        assert done.returncode == 2
        assert one_sentence(done.stderr, "plant.gclip can't be written", why)
        assert (disk / "plant.gclip").read_text() == "old"
        assert not list(disk.glob(".*"))
    finally:
        if mounted:
            subprocess.run(["umount", str(disk)], check=True)


NO_PRIVILEGES = """
import ctypes
head = (ctypes.c_uint32 * 2)(0x20080522, 0)
libc, drop = ctypes.CDLL(None), 24
for number in range(64):
    libc.prctl(drop, number, 0, 0, 0)
assert libc.capset(head, (ctypes.c_uint32 * 6)()) == 0
"""  # root is then held to permissions, and so are the processes that it starts (Linux)


@linux_only
def test_a_read_only_folder_is_said(write_scans, output, tmp_path):
    folder, read_only = write_scans(), output.parent
    read_only.chmod(0o555)
    try:
        for place in (
            ["-o", output],
            ["-o", tmp_path / "p.gclip", "--cache", read_only / "cache"],
        ):
            done = limited(NO_PRIVILEGES, folder, *place)
            assert done.returncode == 2
            assert one_sentence(done.stderr, "ermission denied")
    finally:
        read_only.chmod(0o755)
    left = listing(read_only)
    assert set(left) == {"plant.gclip", "report.html", "traits.csv"}
    assert set(left.values()) == {b"old"}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_stopping_is_one_sentence_and_leaves_nothing(write_scans, output, number):
    arguments = [str(write_scans(days=range(8))), "-o", str(output), "--force"]
    command = [sys.executable, "-m", "baker", *arguments]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    first = process.stderr.readline()
    process.send_signal(number)
    said = process.communicate(timeout=120)[1]
    assert first.startswith("reading")
    assert process.returncode == 128 + number
    assert said.splitlines()[-1] == "bake: stopped; nothing half-written is left behind."
    assert "Traceback" not in said
    assert set(listing(output.parent)) == {"plant.gclip", "report.html", "traits.csv"}
    assert output.read_text() == "old"


def test_nothing_is_written_outside_the_output_and_the_cache(write_scans, tmp_path):
    """But compiled code, which Python and numba keep (docs/cache.md)."""
    scans = write_scans(days=(0, 1))
    places = {name: tmp_path / name for name in ("home", "temporary", "here", "out", "cache")}
    for place in places.values():
        place.mkdir()
    before = listing(scans)
    inherited = {key: value for key, value in os.environ.items() if not key.startswith("XDG_")}
    environment = {
        **inherited,
        "HOME": str(places["home"]),
        "TMPDIR": str(places["temporary"]),
        "PYTHONPATH": str(Path(__file__).parents[2]),
    }
    out = places["out"]
    command = [sys.executable, "-m", "baker", scans, "-o", out / "plant.gclip", "-q"]
    also = ["--report", out / "report.html", "--traits", out / "traits.csv"]
    began = time.time()
    subprocess.run(
        [*map(str, command), *map(str, also), "--cache", str(places["cache"])],
        cwd=places["here"],
        env=environment,
        check=True,
        timeout=120,
    )
    assert listing(scans) == before
    assert listing(places["temporary"]) == listing(places["here"]) == {}
    compiled = (".cache/numba", ".cache/mesa")
    left = [name for name in listing(places["home"]) if not name.startswith(compiled)]
    assert set(left) <= {".cache"}
    assert set(listing(out)) == {"plant.gclip", "report.html", "traits.csv"}
    assert len(list(places["cache"].glob("*/*"))) == 1
    project = Path(__file__).parents[2] / "baker"
    new = [path for path in project.rglob("*") if path.is_file() and path.stat().st_ctime >= began]
    assert not [path for path in new if path.parent.name != "__pycache__" and path.suffix != ".py"]


@linux_only
@pytest.mark.parametrize(
    ("mode", "names_are_given"), [(0o000, False), (0o444, False), (0o444, True), (0o311, True)]
)
def test_folders_and_scans_that_may_not_be_read_are_said(
    write_scans, output, mode, names_are_given
):
    folder = write_scans()
    given = sorted(folder.iterdir()) if names_are_given else [folder]
    folder.chmod(mode)
    try:
        done = limited(NO_PRIVILEGES, *given, "-o", output)
    finally:
        folder.chmod(0o755)
    if mode == 0o311:
        assert done.returncode == 0, done.stderr  # who knows the names may read
    else:
        assert done.returncode == 2, done.stderr
        assert one_sentence(done.stderr, str(folder), "ermission denied")


@linux_only
def test_one_plant_that_may_not_be_read_stops_no_others(write_scans, tmp_path):
    house = tmp_path / "house"
    house.mkdir()
    for name in ("a", "b"):
        write_scans(name=f"house/{name}")
    (house / "a").chmod(0)
    try:
        for given in [house], [house / "a", house / "b"]:
            done = limited(NO_PRIVILEGES, *given, "-o", f"{tmp_path}/clips/", *LIGHT)
            assert done.returncode == 2
            assert "1 of 2 plants failed" in done.stderr
            assert "Permission denied" in done.stderr
    finally:
        (house / "a").chmod(0o755)
    assert [path.name for path in (tmp_path / "clips").iterdir()] == ["b.gclip"]


def test_names_that_no_file_can_have_are_said(write_scans, tmp_path, capsys):
    folder, long = write_scans(), "x" * 300
    for arguments in (
        [long, "-o", tmp_path / "p.gclip"],
        [f"{long}.ply", f"{folder}/day00.txt", "-o", tmp_path / "p.gclip"],
        [folder, "-o", tmp_path / f"{long}.gclip"],
        [folder, "-o", tmp_path / "p.gclip", "--times", f"{long}.txt"],
        [folder, "-o", tmp_path / "p.gclip", "--report", f"{long}.html"],
        [folder, "-o", tmp_path / "p.gclip", "--cache", tmp_path / long],
    ):
        assert main([str(argument) for argument in (*arguments, "-q")]) == 2
        assert one_sentence(capsys.readouterr().err, "ile name too long")
        assert list(tmp_path.iterdir()) == [folder]


@pytest.mark.parametrize("many", [False, True])
def test_a_table_never_takes_the_place_of_an_input(write_scans, tmp_path, capsys, many):
    (tmp_path / "house").mkdir()
    folder = write_scans(name="house/plant")
    times = tmp_path / "times.csv"
    times.write_text("day00.txt,0\nday01.txt,1\nday02.txt,2\n")
    before = listing(tmp_path)
    given, clip = (folder.parent, "clips/") if many else (folder, "p.gclip")
    for table in (folder / "day00.csv", times, folder / ".." / "plant" / "new.csv"):
        arguments = [
            given,
            "--times",
            times,
            "--traits",
            table,
            "-o",
            f"{tmp_path}/{clip}",
            "-q",
            "--force",
        ]
        assert main([*map(str, arguments)]) == 2
        assert one_sentence(capsys.readouterr().err, str(table), "among the inputs")
        assert listing(tmp_path) == before


def test_what_can_never_be_saved_is_refused_before_the_work(write_scans, tmp_path, capsys):
    """Not after hours."""
    arguments = [str(write_scans()), "-o", str(tmp_path / "p.gclip")]
    for more, word in (
        (["--unit", "m" * 2_000], "--unit"),
        (["--cache", ""], "--cache"),
        (["-o", ""], ".gclip"),
    ):
        assert main([*arguments, *more]) == 2
        assert one_sentence(capsys.readouterr().err, word)


@pytest.mark.parametrize("what", ["scan", "folder", "times", "output", "report", "traits"])
def test_a_pipe_that_nobody_writes_to_is_not_waited_for(write_scans, tmp_path, what, capsys):
    folder, pipe = write_scans(), tmp_path / {
        "output": "p.gclip", "report": "p.html", "traits": "p.csv", "scan": "scans/day9.txt"
    }.get(what, "pipe")  # fmt: skip
    os.mkfifo(pipe)
    options = {
        "scan": [folder / "day00.txt", pipe],
        "folder": [pipe],
        "times": [folder, "--times", pipe],
        "output": [folder],
        "report": [folder, "--report", pipe],
        "traits": [folder, "--traits", pipe],
    }[what]
    code = main([str(a) for a in (*options, "-o", tmp_path / "p.gclip", "-q", "--force", *LIGHT)])
    said = capsys.readouterr().err
    if what in ("output", "report", "traits"):  # a file takes the pipe's place
        assert (code, said, pipe.is_file()) == (0, "", True)
    else:
        assert code == 2
        assert one_sentence(said, pipe.name, "not a regular file")


def test_corrections_that_were_not_fetched_are_said(write_scans, tmp_path, capsys):
    """A link to a file that is elsewhere, as git-annex and DVC leave it."""
    (tmp_path / "p.corrections.toml").symlink_to(tmp_path / "annex" / "p.corrections.toml")
    assert main([str(write_scans()), "-o", str(tmp_path / "p.gclip"), "-q"]) == 2
    assert one_sentence(capsys.readouterr().err, "p.corrections.toml' can't be read")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signal")
def test_children_whose_end_is_ignored_are_no_fault(tmp_path):
    """As some shells and services start their programs, with SIGCHLD ignored."""
    plants = [write_las(tmp_path / name) for name in ("a", "b")]
    ignoring = "signal.signal(signal.SIGCHLD, signal.SIG_IGN)"
    for words in (
        [plants[0], "-o", tmp_path / "p.gclip"],
        [*plants, "-o", f"{tmp_path}/clips/", "--workers", "2"],
    ):
        code = f"import signal, sys; {ignoring}; from baker.cli import main; sys.exit(main())"
        command = [sys.executable, "-c", code, *map(str, words), "-q", *LIGHT]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120)
        assert (done.returncode, done.stderr) == (0, "")
    clips = [tmp_path / "p.gclip", *sorted((tmp_path / "clips").iterdir())]
    assert len({clip.read_bytes() for clip in clips}) == 1
