"""Plants shared out among processes of this machine: small plants bake best one a core."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from baker.batch.forks import on_cores
from baker.batch.work import Job, Outcome, bake_plant
from gclip.terminal.command import BAD_INPUT

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

ATTEMPTS = 2  # of a plant whose process dies


def bake_here(jobs: Sequence[Job], workers: int) -> Generator[Outcome, None, None]:
    """`share_out` for baking."""
    return share_out(bake_on_cores, jobs, workers)


def bake_on_cores(job: Job) -> Outcome:
    """Bake a plant on as many cores as its options say."""
    return bake_plant(job, on_cores(job.options.workers)[0])


def share_out(
    work: Callable[[Job], Outcome], jobs: Sequence[Job], workers: int
) -> Generator[Outcome, None, None]:
    """Do `work` on `workers` cores; outcomes come as they are ready. Close it to stop at once.

    work: top-level, so that other processes can import it; it does not raise.

    Where there are fewer plants than cores, each plant takes as many cores as are its share.
    A process that dies (for want of memory, say) is replaced, and its plant tried once more.
    """
    from multiprocessing.connection import wait

    processes = max(1, min(workers, len(jobs)))
    share = max(1, workers // processes)
    waiting = deque((job, 1) for job in jobs)
    crew: list[_Process] = []
    try:
        while waiting or any(process.busy for process in crew):
            while waiting and len(crew) < processes:
                crew.append(_Process(work))
            for process in crew:
                if waiting and not process.busy:
                    job, attempt = waiting.popleft()
                    process.begin(with_cores(job, share), attempt)
            ready = wait([process.pipe for process in crew if process.busy])
            for process in [p for p in crew if p.pipe in ready]:
                job, attempt = process.under_way
                try:
                    outcome = process.outcome()
                except (EOFError, OSError):
                    crew.remove(process)
                    how = process.end()
                    if attempt < ATTEMPTS:
                        waiting.append((job, attempt + 1))
                        continue
                    outcome = lost(job.name, f"its process {how} {ATTEMPTS} times")
                yield outcome
    finally:
        for process in crew:
            process.end()


def with_cores(job: Job, cores: int) -> Job:
    """The same, on so many cores."""
    return replace(job, options=replace(job.options, workers=cores))


def lost(name: str, how: str) -> Outcome:
    """The outcome of a plant that its process did not live to tell of."""
    return Outcome(
        name,
        "failed",
        code=BAD_INPUT,
        error=f"{how}; most likely its scans need more memory than there is: try fewer points "
        "(--voxel, --resample) or fewer plants at once (--workers).",
    )


class _Process:
    """A process that bakes one plant after the other.

    Pipes tell when either end dies: no plant is lost with its process, and no process outlives
    the command.
    """

    def __init__(self, work: Callable[[Job], Outcome]) -> None:
        from multiprocessing import get_context

        # Not forked: libraries that have threads don't survive that.
        context = get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(work, theirs), daemon=True)
        self._process.start()
        theirs.close()
        self._under_way: tuple[Job, int] | None = None

    @property
    def busy(self) -> bool:
        return self._under_way is not None

    @property
    def under_way(self) -> tuple[Job, int]:
        assert self._under_way is not None
        return self._under_way

    def begin(self, job: Job, attempt: int) -> None:
        self._under_way = job, attempt
        with suppress(OSError):  # it died idle: `outcome` will find out
            self.pipe.send(job)

    def outcome(self) -> Outcome:
        found: Outcome = self.pipe.recv()
        self._under_way = None
        return found

    def end(self) -> str:
        """Stop it, if need be in the midst of a plant; how it ended."""
        self.pipe.close()
        if self.busy:
            self._process.terminate()
        self._process.join(timeout=10)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        code = self._process.exitcode or 0
        return f"was killed (signal {-code})" if code < 0 else f"ended (exit code {code})"


def _serve(work: Callable[[Job], Outcome], pipe: Connection) -> None:
    """Do what comes through the pipe until it is closed."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches all: the command decides
    signal.signal(signal.SIGTERM, _stop)
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"  # read when numpy is loaded: there is one plant a core
    try:
        while True:
            pipe.send(work(pipe.recv()))
    except (EOFError, OSError):
        signal.signal(signal.SIGTERM, signal.SIG_IGN)  # it is ending already


def _stop(signal: int, frame: object) -> None:
    """As an exception, so that half-written files are taken away."""
    raise SystemExit(128 + signal)
