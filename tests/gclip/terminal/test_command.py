"""How commands end: an exit code, and one sentence on stderr."""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
from collections.abc import Callable

import pytest
import typer

from gclip.errors import ClipError, UserError
from gclip.terminal.command import run, run_app


def raising(error: BaseException) -> Callable[[], None]:
    def work() -> None:
        raise error

    return work


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (UserError("this is wrong."), 2, "bake: this is wrong.\n"),
        (ClipError("a\nb\x1b[2Jc."), 2, "bake: a\ufffdb\ufffd[2Jc.\n"),
        (MemoryError(), 2, "out of memory; try fewer points"),
        (
            PermissionError(13, "Permission denied", "a\nb"),
            2,
            "bake: a\ufffdb: Permission denied.\n",
        ),
        (FileNotFoundError(2, "No such file", b"x\xff"), 2, "bake: x\ufffd: No such file.\n"),
        (OSError(28, "No space left"), 2, "bake: No space left.\n"),
        (OSError(12, "Cannot allocate memory"), 2, "out of memory; try fewer points"),
        (FileNotFoundError(2, "No such file"), 2, "the folder that the command was started in is"),
        (OSError(22, "Invalid argument"), 1, "internal error (OSError: [Errno 22]"),
        (
            OSError("libusb-1.0.so.0: cannot open shared object file: No such file or directory"),
            2,
            "bake: a library can't be loaded in this environment: libusb-1.0.so.0: cannot open",
        ),
        (
            ImportError("libgfortran.so.5: failed to map segment from shared object"),
            2,
            "bake: a library can't be loaded in this environment: libgfortran.so.5: failed to map",
        ),
        (ImportError("cannot import name 'x'"), 1, "internal error (ImportError: "),
        (KeyboardInterrupt(), 130, "stopped; nothing half-written"),
        (ZeroDivisionError("one\ntwo"), 1, "internal error (ZeroDivisionError: one two)"),
    ],
)
def test_outcomes(
    error: BaseException, code: int, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("bake", raising(error)) == code
    out, err = capsys.readouterr()
    assert out == ""
    assert words in err
    assert (err.startswith("bake: "), err.count("\n")) == (True, 1)


@pytest.mark.parametrize(
    ("module", "variable", "value", "said"),
    [
        (
            "numpy.f2py",
            "SOURCE_DATE_EPOCH",
            "then",
            "can't be loaded in this environment: .*'then'",
        ),
        ("numba", "NUMBA_NUM_THREADS", "0", "can't be loaded in this environment: .* must be > 0"),
        ("numba", "NUMBA_NUM_THREADS", "many", "warning: .*'NUMBA_NUM_THREADS'.*'many'.*parsed"),
        (
            "baker.transport.partition_kernels",
            "NUMBA_DISABLE_JIT",
            "1",
            "NUMBA_DISABLE_JIT is set .* unset it",
        ),
    ],
)
def test_a_wrong_variable_of_the_environment_is_one_sentence(
    module: str, variable: str, value: str, said: str
) -> None:
    code = (
        "from importlib import import_module; from gclip.terminal.command import run;"
        f"run('bake', lambda: import_module('{module}') and None)"
    )
    command, environment = [sys.executable, "-c", code], {**os.environ, variable: value}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert re.fullmatch(f"bake: .*{said}.*\\.\n", done.stderr)


def test_what_is_done_is_done(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("bake", lambda: None) == 0
    assert run("bake", lambda: 2) == 2
    assert capsys.readouterr() == ("", "")


def test_a_fault_of_our_own_can_be_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GCLIP_TRACEBACK", "1")
    with pytest.raises(ZeroDivisionError):
        run("bake", raising(ZeroDivisionError()))
    assert run("bake", raising(UserError("this is wrong."))) == 2


def test_a_reader_that_goes_away_is_no_fault() -> None:
    """As `play plant.gclip --info | head -1` has it."""
    code = (
        "import sys; from gclip.terminal.command import run\n"
        "def work():\n"
        "    while True: print('x' * 1000, flush=True)\n"
        "sys.exit(run('play', work))"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 0


@pytest.mark.parametrize("module", ["baker", "player", "grow", "gclip"])
def test_help_that_nobody_reads_on_is_no_fault(module: str) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-m", module, "--help"], stdout=writer, stderr=subprocess.PIPE
    )
    os.close(writer)
    assert (done.returncode, done.stderr) == (0, b"")


def test_letters_that_a_terminal_lacks_are_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, encoding="ascii"))
    assert run("play", lambda: print("10 × 20 – ½")) == 0
    sys.stdout.flush()
    assert written.getvalue() == b"10 ? 20 ? ?\n"


def test_words_that_typer_refuses_are_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    app = typer.Typer(add_completion=False)

    @app.command()
    def work(count: int = 1, code: int = 0) -> None:
        raise typer.Exit(code)

    assert run_app(app, "play", ["--count", "many"]) == 2
    assert "see `play --help`." in capsys.readouterr().err
    assert run_app(app, "play", ["--code", "0"]) == 0
    assert run_app(app, "play", ["--code", "2"]) == 2
    assert run_app(app, "play", ["--code", "130"]) == 130


def test_a_typer_app_may_write_to_a_reader_that_goes_away() -> None:
    code = (
        "import sys, typer; from gclip.terminal.command import run_app\n"
        "app = typer.Typer(add_completion=False)\n"
        "@app.command()\n"
        "def work():\n"
        "    while True: print('x' * 1000, flush=True)\n"
        "sys.exit(run_app(app, 'play', []))"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 0
