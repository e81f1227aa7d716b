"""A file that is cut short while it is open: noticed, not followed over its edge."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gclip
from gclip.file import check_not_truncated


def test_a_clip_cut_short_while_open_is_a_sentence(make_clip, tmp_path: Path) -> None:
    path = tmp_path / "c.gclip"
    make_clip().save(path)
    clip = gclip.open(path)
    check_not_truncated(clip.intervals[0].tracks)
    os.truncate(path, 100)
    for interval in clip.intervals:
        for buffer in (*interval.curve, interval.tracks):
            with pytest.raises(gclip.ClipError, match="cut short while it was open") as refusal:
                check_not_truncated(buffer)
    assert str(refusal.value).startswith(str(path))
    with pytest.raises(gclip.ClipError, match="cut short"):
        clip.at(1.0)


def test_replacing_the_file_leaves_an_open_clip_whole(make_clip, tmp_path: Path) -> None:
    path = tmp_path / "c.gclip"
    make_clip().save(path)
    clip = gclip.open(path)
    before = clip.at(1.0).positions
    make_clip(degree=3).save(path)
    assert np.array_equal(clip.at(1.0).positions, before)
    path.unlink()
    assert np.array_equal(clip.at(1.0).positions, before)


def test_a_clip_in_memory_is_whole(make_clip) -> None:
    check_not_truncated(make_clip().intervals[0].tracks)


def test_it_is_a_sentence_and_not_a_signal(make_clip, tmp_path: Path) -> None:
    """In a process that may die of it."""
    path = tmp_path / "c.gclip"
    make_clip().save(path)
    code = (
        "import os, sys, gclip; clip = gclip.open(sys.argv[1]); os.truncate(sys.argv[1], 0)\n"
        "try: print(clip.at(1.0))\n"
        "except gclip.ClipError as error: sys.exit(str(error))"
    )
    done = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True)
    assert done.returncode == 1, "a sentence, not a signal"
    assert "cut short" in done.stderr
