"""Intervals kept in a folder from bake to bake (`bake --cache DIR`).

An interval is found again by a digest of all that it is worked out from: its job, the program's own
code, the versions of its packages and the kind of machine. It is kept as MessagePack, which runs no
code when it is read, behind a digest of its own bytes.

One folder may serve many bakes at once, on several machines too, which is why it holds plain files
and no data base.
"""

import platform
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from baker.errors import InputError
from baker.geometry.parallel import ReportProgress
from baker.interpolation.interval_job import IntervalJob, IntervalSolver
from baker.interpolation.provenance import software
from gclip.errors import ClipError
from gclip.file import Container
from gclip.interval import Interval, read_interval
from gclip.schema import IntervalEntry
from gclip.terminal.atomic import atomic_file


class Cache:
    """Keep intervals in `folder`; it may be deleted at any time. InputError where it can't be made.

    What is missing, damaged or another job's is solved again and replaced. Where the folder can't
    take an interval, the bake goes on without. `found` and `solved` count the intervals that were
    taken from the folder, and that were not; `trouble` says why some could not be kept.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.found = self.solved = 0
        self.trouble = ""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{folder} can't be a cache: {error.strerror or error}.") from None

    def kept_intervals(self, solve: IntervalSolver) -> IntervalSolver:
        """The solver with its intervals kept, each as soon as it and those before it are solved."""

        def look_up(
            jobs: Sequence[IntervalJob], report_progress: ReportProgress
        ) -> Iterator[Interval]:
            keys = [self._key(job) for job in jobs]
            tracks = 1 + max((task.organ for job in jobs for task in job.tasks), default=0)
            kept = [
                found if found is not None and _is_interval(found, job, tracks) else None
                for found, job in zip(map(self._read, keys), jobs, strict=True)
            ]
            missing = [job for job, interval in zip(jobs, kept, strict=True) if interval is None]
            self.found, self.solved = len(jobs) - len(missing), len(missing)
            solved = iter(solve(missing, report_progress))
            for key, found in zip(keys, kept, strict=True):
                yield self._write(key, next(solved)) if found is None else found

        return look_up

    def summary(self) -> str:
        """How many intervals were found, and what the folder did not take."""
        found = f"{self.found} of {self.found + self.solved} intervals"
        return f"{found}; not all others could be kept: {self.trouble}" if self.trouble else found

    @cached_property
    def _program(self) -> bytes:
        """Digest of the code, the packages and the machine: no result outlives a change of them."""
        import baker
        import gclip

        folders = [Path(str(package.__file__)).parent for package in (baker, gclip)]
        code = [path.read_bytes() for folder in folders for path in sorted(folder.rglob("*.py"))]
        return sha256(_encoded((software(), platform.machine(), code))).digest()

    def _key(self, job: Any) -> str:
        return sha256(_encoded((self._program, job))).hexdigest()

    def _read(self, key: str) -> Interval | None:
        path = self.folder / key[:2] / key
        with suppress(OSError, msgspec.MsgspecError):
            entry = memoryview(path.read_bytes() if path.is_file() else b"")
            if sha256(key.encode() + entry[32:]).digest() == entry[:32]:
                return msgspec.msgpack.decode(entry[32:], type=Interval, dec_hook=_array)
        return None

    def _write(self, key: str, interval: Interval) -> Interval:
        path, payload = self.folder / key[:2] / key, _encoded(interval)
        try:
            path.parent.mkdir(exist_ok=True)
            with atomic_file(path) as part:
                part.write_bytes(sha256(key.encode() + payload).digest() + payload)
        except OSError as error:
            self.trouble = self.trouble or f"{path} can't be written: {error.strerror or error}"
        return interval


# Whoever writes into the folder may have forged what lies in it: none of it may stop a bake.


def _is_interval(interval: Interval, job: IntervalJob, tracks: int) -> bool:
    with suppress(ClipError, msgspec.MsgspecError):
        buffers = interval.buffers(0)
        entry = msgspec.convert(interval, IntervalEntry, from_attributes=True)
        read_interval(Container("", buffers, 0, {*buffers}), 0, entry, tracks)
        return (interval.start, interval.end) == job.times
    return False


def _encoded(value: Any) -> bytes:
    """Dataclasses, containers, numbers, text and arrays as MessagePack."""
    return msgspec.msgpack.encode(value, enc_hook=_plain)


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return (value.dtype.str, value.shape, np.ascontiguousarray(value).data.cast("B"))
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} has no digest")


def _array(kind: type, value: Any) -> Any:
    """What `_plain` made of an array: read-only."""
    dtype, shape, data = value
    return np.frombuffer(data, dtype).reshape(shape)
