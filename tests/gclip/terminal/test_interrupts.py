"""Stops reach the work wherever it is."""

from __future__ import annotations

import gc
import importlib
import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from gclip.terminal.atomic import folder_beside
from gclip.terminal.command import run
from gclip.terminal.interrupts import uninterrupted


@pytest.fixture(autouse=True)
def usual_handler() -> Iterator[None]:
    """As a command finds it when it starts, whatever other tests have loaded."""
    before, hook = signal.signal(signal.SIGINT, signal.default_int_handler), sys.unraisablehook
    yield
    signal.signal(signal.SIGINT, before)
    sys.unraisablehook = hook  # which a command that is stopped leaves changed


def test_a_stop_that_python_drops_is_sent_again(capsys: pytest.CaptureFixture[str]) -> None:
    class Dropped:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGINT)

    def work() -> None:
        Dropped()
        time.sleep(20)

    assert run("bake", work) == 130
    assert capsys.readouterr().err == "bake: stopped; nothing half-written is left behind.\n"


def test_an_object_whose_creation_is_stopped_is_deleted_without_a_word(
    capsys: pytest.CaptureFixture[str],
) -> None:
    class HalfMade:
        def __init__(self) -> None:
            signal.raise_signal(signal.SIGINT)
            self.handle = 1

        def __del__(self) -> None:
            assert self.handle

    def work() -> None:
        HalfMade()

    sys.unraisablehook = sys.__unraisablehook__  # which prints to stderr
    assert run("bake", work) == 130
    gc.collect()
    assert capsys.readouterr().err == "bake: stopped; nothing half-written is left behind.\n"


def test_a_stop_while_a_module_loads_is_not_lost(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "swallows_stops.py").write_text(
        "import signal\n"
        "try:\n    signal.raise_signal(signal.SIGINT)\nexcept KeyboardInterrupt:\n    pass\n"
        "loaded = True\n"
    )
    monkeypatch.syspath_prepend(tmp_path)

    def work() -> None:
        assert importlib.import_module("swallows_stops").loaded
        time.sleep(20)

    assert run("bake", work) == 130
    assert capsys.readouterr().err == "bake: stopped; nothing half-written is left behind.\n"


def test_a_stop_while_a_folder_is_made_leaves_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make = os.mkdir

    def make_and_stop(path: str, mode: int) -> None:
        make(path, mode)
        signal.raise_signal(signal.SIGINT)

    def work() -> None:
        with folder_beside(tmp_path / "plant.gclip"):
            time.sleep(20)

    monkeypatch.setattr(os, "mkdir", make_and_stop)
    assert run("bake", work) == 130
    assert not any(tmp_path.iterdir())


def test_a_stop_waits_for_native_code_that_calls_python() -> None:
    done = []

    def called_back() -> None:
        signal.raise_signal(signal.SIGINT)
        done.append("called back")

    def work() -> None:
        uninterrupted(called_back)
        time.sleep(20)
        done.append("slept")

    assert run("play", work) == 130
    assert done == ["called back"]


def test_a_stop_that_waits_until_the_work_is_done_stops_nothing_else() -> None:
    assert run("play", lambda: uninterrupted(signal.raise_signal, signal.SIGINT)) == 0
    time.sleep(0.1)


def test_a_second_stop_does_not_disturb_putting_away(capsys: pytest.CaptureFixture[str]) -> None:
    away = []

    def work() -> None:
        try:
            signal.raise_signal(signal.SIGINT)
        finally:
            signal.raise_signal(signal.SIGINT)
            away.append("put")

    assert run("bake", work) == 130
    assert away == ["put"]


def test_the_signal_decides_the_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    before = signal.signal(signal.SIGTERM, signal.SIG_DFL)
    try:
        assert run("bake", lambda: signal.raise_signal(signal.SIGTERM)) == 143
        assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        assert run("bake", lambda: signal.raise_signal(signal.SIGTERM)) == 0
    finally:
        signal.signal(signal.SIGTERM, before)
