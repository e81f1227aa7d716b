"""An export beside the window: in a process of its own, with progress, and easily stopped."""

from __future__ import annotations

import multiprocessing
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from player.errors import PlayerError

if TYPE_CHECKING:
    from player.export.film import Film

PATIENCE = 5.0  # seconds that a stopped export has for tidying up


class Stopped(Exception):
    """The user stopped it."""


@dataclass(frozen=True)
class State:
    """Steps done of all; `ended` with a sentence for the user once it is over."""

    done: int = 0
    total: int = 0
    ended: str = ""


class Export:
    """One export under way; a process, so that the window stays smooth."""

    def __init__(self, clip: Path, film: Film, output: Path) -> None:
        fresh = multiprocessing.get_context("spawn")
        self.name = output.name
        self.state = State()
        self._events, sending = fresh.Pipe(duplex=False)
        self._stop = fresh.Event()
        job = (str(clip), film, str(output), sending, self._stop)
        self._process = fresh.Process(target=run, args=job, daemon=True)
        self._process.start()
        sending.close()

    def look(self) -> State:
        """What has happened by now."""
        try:
            while self._events.poll():
                self.state = self._events.recv()
        except (EOFError, OSError):
            if not self.state.ended:
                self.state = State(ended=f"Exporting {self.name} failed.")
        if self.state.ended:
            self._process.join(PATIENCE)
        return self.state

    def stop(self) -> None:
        """Ask it to leave, and to leave nothing behind."""
        self._stop.set()

    def release(self) -> None:
        """Stop it now, whatever it does."""
        self.stop()
        self._process.join(PATIENCE)
        if self._process.is_alive():
            self._process.kill()


def run(clip: str, film: Film, output: str, events: Any, stop: Any) -> None:
    """What the process does."""
    import signal

    import gclip
    from gclip.errors import ClipError
    from player.export import export

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the window decides, also about Ctrl-C

    def tell(state: State) -> None:
        try:
            events.send(state)
        except OSError:  # the window is gone
            raise Stopped from None

    def progress(done: int, total: int) -> None:
        if stop.is_set():
            raise Stopped
        tell(State(done, total))

    name = Path(output).name
    try:
        export(gclip.open(clip), film, Path(output), progress)
        ended = f"Saved {output}"
    except Stopped:
        ended = f"Stopped: {name} was not written."
    except (PlayerError, ClipError) as error:
        ended = str(error)
    except Exception as error:
        ended = f"Exporting {name} failed: {error or type(error).__name__}."
    with suppress(Stopped):
        tell(State(ended=ended))
