"""ffmpeg at the other end of a pipe (the binary that imageio-ffmpeg brings)."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import IO, TYPE_CHECKING

import numpy as np

from player.errors import PlayerError

if TYPE_CHECKING:
    from numpy.typing import NDArray

# The same pictures give the same bytes: no version or date is written, threads are a fixed number.
REPRODUCIBLE = ("-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1")


def encode(
    pictures: Iterable[NDArray[np.uint8]],
    size: tuple[int, int],
    fps: int,
    arguments: Sequence[str],
    output: Path,
) -> None:
    """Send (height, width, 4) pictures through ffmpeg into `output`.

    arguments: ffmpeg's, between the input and the output; the pictures are its input 0.
    Raises PlayerError with ffmpeg's own words where it fails.
    """
    source = ["-f", "rawvideo", "-pix_fmt", "rgb0", "-s", f"{size[0]}x{size[1]}", "-r", str(fps)]
    command = [
        *(_ffmpeg(), "-hide_banner", "-loglevel", "error", "-y"),
        *(*source, "-i", "pipe:0", *arguments, *REPRODUCIBLE, str(output.absolute())),
    ]
    with tempfile.TemporaryFile(dir=output.parent) as words:
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=words, stderr=words)
        assert process.stdin is not None
        try:
            with ThreadPoolExecutor(1) as sender:
                sent: Future[int] | None = None
                for picture in pictures:
                    ready = np.ascontiguousarray(picture)
                    if sent is not None:
                        sent.result()  # one on its way while the next is drawn, never more
                    sent = sender.submit(_send, ready, process.stdin)
                if sent is not None:
                    sent.result()
            process.stdin.close()
        except BrokenPipeError:
            pass  # ffmpeg has given up: its exit code and its words tell why
        except BaseException:
            process.kill()
            raise
        finally:
            process.wait()
        if process.returncode:
            words.seek(0)
            lines = words.read().decode("utf-8", "replace").strip().splitlines()
            reason = lines[-1].rstrip(".") if lines else f"exit code {process.returncode}"
            raise PlayerError(f"{output.name} can't be encoded: ffmpeg says: {reason}.")


def _send(picture: NDArray[np.uint8], pipe: IO[bytes]) -> int:
    return pipe.write(picture.data)


def _ffmpeg() -> str:
    from imageio_ffmpeg import get_ffmpeg_exe

    try:
        return get_ffmpeg_exe()
    except RuntimeError:
        raise PlayerError(
            "no ffmpeg was found; install the package imageio-ffmpeg, or ffmpeg itself."
        ) from None
