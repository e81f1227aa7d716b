"""The command `bake`: exit codes, one-sentence errors, nothing half-written."""

import ctypes
import os
import re
import signal
import subprocess
import sys
import time
from importlib import import_module

import numpy as np
import pytest

import gclip
from baker.cli import main


def test_a_bake_from_the_command_line(write_scans, tmp_path, capsys):
    out = tmp_path / "plant.gclip"
    assert main([str(write_scans()), "-o", str(out), "--align", "none"]) == 0
    assert len(gclip.open(out).intervals) == 2
    summary = capsys.readouterr().err
    for words in (
        "scans",
        "points",
        "organs",
        "born and 0 lost",
        "up",
        str(out),
        "MB",
    ):
        assert words in summary
    assert "movers" not in summary
    assert {p.name for p in tmp_path.iterdir()} == {"scans", "out", "plant.gclip"}


def test_quiet_is_silent(write_scans, tmp_path, capsys):
    out = tmp_path / "plant.gclip"
    assert main([str(write_scans()), "-o", str(out), "--align", "none", "-q"]) == 0
    captured = capsys.readouterr()
    assert captured.out == captured.err == ""


def test_verbose_names_the_fields_and_the_solvers(write_scans, tmp_path, capsys):
    out = tmp_path / "plant.gclip"
    assert main([str(write_scans()), "-o", str(out), "--align", "none", "-v"]) == 0
    said = capsys.readouterr().err
    for words in ("labels  sure", "movers", "segment pairs", "network simplex"):
        assert words in said


def refused(argv, capsys, *words) -> None:
    assert main([str(word) for word in argv]) == 2
    captured = capsys.readouterr()
    lines = captured.err.strip().splitlines()
    assert lines[-1].startswith("bake: ")
    assert "Traceback" not in captured.err
    for word in words:
        assert word in lines[-1]


@pytest.fixture
def out(tmp_path):
    return tmp_path / "out" / "plant.gclip"


@pytest.fixture(autouse=True)
def nothing_is_written(tmp_path):
    (tmp_path / "out").mkdir()
    yield
    assert not list((tmp_path / "out").iterdir())


def test_wrong_usage(capsys, out):
    refused([], capsys, "INPUT")
    refused(["x", "-o", out, "--align", "sideways"], capsys, "align")
    refused(["x", "-o", out, "--nope"], capsys, "--nope")
    refused(["x", "-o", out, "--root", "1,2"], capsys, "--root is (1.0, 2.0); a place")
    refused(["x", "-o", out, "--workers", "-1"], capsys, "workers")
    refused(["x", "-o", out, "--columns", "x,y,label"], capsys, "x,y,label", "x, y, z")
    refused(["x", "-o", out, "--columns", ","], capsys, "--columns is ,", "x, y, z")
    refused(["x", "-o", out, "--fields", ","], capsys, "--fields is ,; a name is needed")
    refused(["x", "-o", out, "--drop-label", ", "], capsys, "--drop-label is , ; a name is needed")
    refused(["x", "-o", out, "--scale", "0"], capsys, "scale is 0")


def test_bad_outputs(capsys, write_scans, tmp_path):
    folder = write_scans()
    refused([folder, "-o", tmp_path / "plant.mp4"], capsys, ".gclip")
    refused([folder, "-o", tmp_path / "nowhere" / "plant.gclip"], capsys, "nowhere", "No such file")


def test_bad_inputs(capsys, write_scans, tmp_path, out):
    empty = tmp_path / "empty"
    empty.mkdir()
    refused([empty, "-o", out], capsys, "empty")
    refused([tmp_path / "missing", "-o", out], capsys, "missing")
    one = write_scans(days=(0,), name="one")
    refused([one, "-o", out], capsys, "day00.txt")
    twins = write_scans(name="twins")
    (twins / "Day0.txt").write_text((twins / "day00.txt").read_text())
    refused([twins, "-o", out], capsys, "day00.txt", "Day0.txt")
    broken = write_scans(name="broken")
    (broken / "day01.txt").write_text("1 2 3 0\n4 five 6 0\n")
    refused([broken, "-o", out], capsys, "day01.txt", "line 2", "five")
    nothing = write_scans(name="nothing")
    (nothing / "day01.txt").write_text("")
    refused([nothing, "-o", out], capsys, "day01.txt")
    nans = write_scans(name="nans")
    (nans / "day01.txt").write_text("nan nan nan 0\n" * 5)
    refused([nans, "-o", out], capsys, "day01.txt")
    units = write_scans(name="units")
    np.savetxt(units / "day02.txt", np.loadtxt(units / "day02.txt") * [1000, 1000, 1000, 1])
    refused([units, "-o", out], capsys, "day02.txt", "units", "0.001")
    refused([units, "-o", out, "--drop-label", "soil"], capsys, "soil", "no scan has such a label")
    unknown = tmp_path / "scan.docx"
    unknown.write_text("x")
    refused([unknown, unknown, "-o", out], capsys, "scan.docx", ".ply")


def test_ctrl_c_leaves_nothing_behind(write_scans, tmp_path):
    folder = write_scans(days=tuple(range(8)))
    out = tmp_path / "out" / "plant.gclip"
    command = [sys.executable, "-m", "baker", str(folder), "-o", str(out), "--align", "none"]
    bake = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env={**os.environ})
    assert bake.stderr is not None
    bake.stderr.readline()  # the first stage is done: the bake is under way
    time.sleep(0.05)
    bake.send_signal(signal.SIGINT)
    rest = bake.stderr.read()
    assert bake.wait(timeout=120) == 130
    assert rest.strip().splitlines()[-1].startswith("bake: stopped")


def test_help_needs_nothing_heavy():
    code = (
        "import sys; from baker.cli import main; main(['--help']); "
        "heavy = {'numpy', 'scipy', 'open3d', 'ot', 'moderngl'} & set(sys.modules); "
        "sys.exit(f'imported {heavy}' if heavy else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "--align" in done.stdout


COUNT_ARENAS = """
import ctypes, sys, threading
from baker.cli import share_arena
libc = ctypes.CDLL(None)
if sys.argv[2] == "shared":
    share_arena()
barrier = threading.Barrier(4)
def allocate():
    blocks = [bytes(5000) for _ in range(1000)]
    barrier.wait()
threads = [threading.Thread(target=allocate) for _ in range(4)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
libc.fopen.restype = ctypes.c_void_p
file = ctypes.c_void_p(libc.fopen(sys.argv[1].encode(), b"w"))
libc.malloc_info(0, file)
libc.fclose(file)
"""


def test_threads_share_one_arena(tmp_path):
    if not hasattr(ctypes.CDLL(None), "malloc_info"):
        pytest.skip("arenas are glibc's")
    arenas = {}
    for way in ("shared", "own"):
        file = tmp_path / way
        subprocess.run([sys.executable, "-c", COUNT_ARENAS, str(file), way], check=True)
        arenas[way] = file.read_text().count("<heap nr=")
    assert arenas["shared"] == 1 < arenas["own"]


def test_sums_are_rounded_alike_on_every_machine():
    """Threads of the linear algebra would share out sums by the number of cores."""
    code = (
        "from baker.cli import main; main(['--help']); import os;"
        "print({os.environ[n] for n in ('OMP_NUM_THREADS', 'OPENBLAS_NUM_THREADS')})"
    )
    command = [sys.executable, "-c", code]
    many = {**os.environ, "OMP_NUM_THREADS": "4"}
    done = subprocess.run(command, capture_output=True, text=True, env=many)
    assert done.stdout.endswith("{'1'}\n")


def test_the_first_bake_says_that_it_compiles_and_later_ones_do_not(write_scans, tmp_path):
    folder, out = write_scans(days=(0, 1)), tmp_path / "plant.gclip"
    command = [sys.executable, "-m", "baker", str(folder), "-o", str(out), "--force"]
    command += ["--align", "none"]
    empty = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "code")}
    first, second = (
        subprocess.run(command, capture_output=True, text=True, env=empty) for _ in range(2)
    )
    assert (first.returncode, second.returncode) == (0, 0), first.stderr + second.stderr
    assert "compiling the solver, once" in first.stderr
    assert "compiling" not in second.stderr


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--workers", "x"], "--workers is 'x'; Input should be a valid integer, unable to parse"),
        (["--workers", "-1"], "--workers is '-1'; Input should be greater than or equal to 0"),
        (["--even", "11"], "--even is '11'; Input should be less than or equal to 10"),
        (["--even", "many"], "--even is 'many'; Input should be a valid number"),
        (["--up=Q"], "--up is 'Q'; 'Q' is not one of 'auto', 'x', 'y', 'z', '-x', '-y', '-z'"),
        (["--every", ""], "--every is ''; Input should be a valid integer"),
        (["--workers", "9" * 5000], "…; Unable to parse input string as an integer, exceeded"),
        (["--unit"], "Option '--unit' requires an argument"),
    ],
)
def test_a_bad_value_is_one_sentence_that_names_the_option(capsys, words, sentence):
    assert main(["scans", *words]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert said.startswith("bake: ")
    assert said.endswith("; see `bake --help`.\n")
    assert said.count("\n") == 1
    assert len(said) < 250


def test_the_case_of_a_choice_does_not_matter(capsys):
    assert main(["no-such-folder", "-o", "plant.gclip", "--up", "Z"]) == 2
    assert "no-such-folder" in capsys.readouterr().err


@pytest.mark.parametrize("program", ["baker", "player", "grow", "gclip"])
def test_a_help_has_an_example_and_no_types_of_switches(capsys, program):
    assert import_module(f"{program}.cli").main(["--help"]) == 0
    shown = capsys.readouterr().out
    assert shown.count("<bool>") == (program != "gclip"), "only of --help, which is typer's"
    assert program == "gclip" or re.search(r"\b(bake scans|play plant|grow maize)", shown)
