"""Cache solved intervals in a folder (`bake --cache DIR`), which several bakes may use at once.

The key of an interval is a digest of everything that it depends on: its job, the program's code,
the versions of its packages and the type of the machine. The entry, a file, is MessagePack, which
executes no code on reading, after a digest of its bytes.
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

from baker.geometry.parallel import ReportProgress
from baker.interpolation.interval_job import IntervalJob, solve_intervals
from baker.interpolation.provenance import software
from gclip import Interval
from gclip.errors import UserError
from gclip.terminal.atomic import atomic_file, writing


class Cache:
    """A cache of intervals in `folder`, which may be deleted at any time.

    Intervals whose entries are missing or damaged are solved and written again. A bake continues if
    an interval can't be written. Raises UserError if the folder can't be made.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.read = self.solved = 0  #: numbers of intervals of the latest bake
        self.write_error = ""  #: why an interval could not be written, "" if all could
        with writing(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)

    def solve_intervals(
        self, jobs: Sequence[IntervalJob], report_progress: ReportProgress, workers: int = 1
    ) -> Iterator[Interval]:
        """Yield all intervals, solving those that are not in the cache and writing them to it.

        It replaces `baker.interpolation.interval_job.solve_intervals`.
        """
        keys = [self._key(job) for job in jobs]
        tracks = 1 + max((task.organ for job in jobs for task in job.tasks), default=0)
        cached = [self._read(key, job, tracks) for key, job in zip(keys, jobs, strict=True)]
        missing = [job for job, interval in zip(jobs, cached, strict=True) if interval is None]
        self.read, self.solved = len(jobs) - len(missing), len(missing)
        solved = solve_intervals(missing, report_progress, workers)
        for key, interval in zip(keys, cached, strict=True):
            yield self._write(key, next(solved)) if interval is None else interval

    def summary(self) -> str:
        """How many intervals were read from the cache, and why others could not be written."""
        share = f"{self.read} of {self.read + self.solved} intervals"
        error = f"; not all others could be kept: {self.write_error}" if self.write_error else ""
        return share + error

    @cached_property
    def _program(self) -> tuple[Any, ...]:
        """Versions of packages, type of the machine and digest of the code, parts of all keys."""
        packages = [Path(__file__).parents[2] / name for name in ("baker", "corrections", "gclip")]
        code = [path.read_bytes() for package in packages for path in sorted(package.rglob("*.py"))]
        return software(), platform.machine(), sha256(b"".join(code)).digest()

    def _key(self, job: Any) -> str:
        return sha256(_encoded((self._program, job))).hexdigest()

    def _read(self, key: str, job: IntervalJob, tracks: int) -> Interval | None:
        """The entry of a key, or None unless it is a valid interval of the job."""
        path = self.folder / key[:2] / key
        with suppress(OSError, msgspec.MsgspecError):
            entry = memoryview(path.read_bytes() if path.is_file() else b"")
            if sha256(key.encode() + entry[32:]).digest() != entry[:32]:
                return None
            interval = msgspec.msgpack.decode(entry[32:], type=Interval, dec_hook=_decode_array)
            if interval.curve and (interval.start, interval.end) == job.times:
                return interval if interval.tracks.max() < tracks else None
        return None

    def _write(self, key: str, interval: Interval) -> Interval:
        """Write an entry, or set `write_error`; returns the interval."""
        path, payload = self.folder / key[:2] / key, _encoded(interval)
        try:
            with writing(path):
                path.parent.mkdir(exist_ok=True)
                with atomic_file(path) as part:
                    part.write_bytes(sha256(key.encode() + payload).digest() + payload)
        except UserError as error:
            self.write_error = self.write_error or str(error).rstrip(".")
        return interval


def _encoded(value: Any) -> bytes:
    """Dataclasses, containers, numbers, text and arrays as MessagePack."""
    return msgspec.msgpack.encode(value, enc_hook=_encode_array)


def _encode_array(value: Any) -> Any:
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return (value.dtype.str, value.shape, np.ascontiguousarray(value).data.cast("B"))
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} has no digest")


def _decode_array(kind: type, value: Any) -> Any:
    """The inverse of `_encode_array`; the array is read-only."""
    dtype, shape, data = value
    return np.frombuffer(data, dtype).reshape(shape)
