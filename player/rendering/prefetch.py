"""Reads an interval from disk in a thread before it is needed."""

import mmap
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from gclip import Interval
from gclip.errors import ClipError
from gclip.file import check_not_truncated
from player.rendering.point_buffers import buffers_of

STEP = 4096  # pages read between checks whether the interval is still wanted


class Prefetch:
    """Reads one interval at a time into memory.

    A clip is memory-mapped, so its pages are read from disk when they are first touched. Touching
    them here keeps the upload from waiting for the disk.
    """

    def __init__(self) -> None:
        self._executor = ThreadPoolExecutor(1)
        self._wanted: int | None = None
        self._reading: dict[int, Future[bool]] = {}

    def start(self, index: int, interval: Interval) -> None:
        """Begin to read an interval, and cancel an earlier one; does nothing the second time."""
        if index != self._wanted and not self.done(index):
            self._wanted = index
            self._reading[index] = self._executor.submit(self._read, index, interval)

    def done(self, index: int) -> bool:
        found = self._reading.get(index)
        return found is not None and found.done() and found.result()

    def stop(self) -> None:
        self._wanted = None
        self._executor.shutdown(cancel_futures=True)

    def _read(self, index: int, interval: Interval) -> bool:
        """Returns whether all of the interval was read."""
        for buffer in buffers_of(interval):
            if not buffer.flags.c_contiguous:
                continue
            pages = buffer.reshape(-1).view(np.uint8)[:: mmap.PAGESIZE]
            for first in range(0, len(pages), STEP):
                if self._wanted != index:
                    return False
                try:
                    check_not_truncated(buffer)
                except ClipError:  # reported when it is uploaded
                    return False
                pages[first : first + STEP].max(initial=0)
        return True
