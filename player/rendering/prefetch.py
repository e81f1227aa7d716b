"""Reads an interval from the disk in a thread, before it is needed."""

from __future__ import annotations

import mmap
import threading
from typing import TYPE_CHECKING

from gclip.errors import ClipError

if TYPE_CHECKING:
    from gclip import Interval

STEP = 1 << 24  # bytes between looks at whether the interval is still wanted


class Fetcher:
    """Has one interval at a time read into memory.

    A clip is memory-mapped: its pages come from the disk when they are first touched. They are
    touched here, so that uploading them later doesn't wait for the disk.
    """

    def __init__(self) -> None:
        self._wanted: int | None = None
        self._done: set[int] = set()
        self._thread: threading.Thread | None = None

    def fetch(self, index: int, interval: Interval) -> None:
        """Begin with an interval, unless it is under way or done; an earlier one is given up."""
        if index in (self._wanted, *self._done):
            return
        self._wanted = index
        if self._thread is not None:
            self._thread.join()
        self._thread = threading.Thread(target=self._read, args=(index, interval), daemon=True)
        self._thread.start()

    def done(self, index: int) -> bool:
        return index in self._done

    def stop(self) -> None:
        self._wanted = None
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def _read(self, index: int, interval: Interval) -> None:
        import numpy as np

        from gclip.file import check_whole

        for buffer in (
            *(*interval.curve, interval.tracks),
            *(c for c in (interval.start_colors, interval.end_colors) if c is not None),
        ):
            if not buffer.flags.c_contiguous:
                continue
            pages = buffer.reshape(-1).view(np.uint8)[:: mmap.PAGESIZE]
            for first in range(0, len(pages), STEP // mmap.PAGESIZE):
                if self._wanted != index:
                    return
                try:
                    check_whole(buffer)
                except ClipError:  # who uploads it tells
                    return
                pages[first : first + STEP // mmap.PAGESIZE].max(initial=0)
        self._done.add(index)
        self._wanted = None
