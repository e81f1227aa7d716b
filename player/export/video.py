"""Export of films as MP4 or QuickTime (H.264), WebM (VP9) and GIF by imageio's ffmpeg."""

import logging
from collections.abc import Iterable, Sequence
from contextlib import closing
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.errors import PlayerError
from player.export.film import Film, Progress
from player.output_names import write_error

PALETTE_SAMPLES = 8  # frames of the film from which a GIF's palette is computed
MAX_GIF_FPS = 50  # browsers slow down GIFs with delays below 2/100 s

# Convert RGB by ITU-R BT.709, and tag the film with it; without tags, players would guess.
BT709 = (
    "-vf",
    "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,format=yuv420p,"
    "setparams=colorspace=bt709:color_primaries=bt709:color_trc=bt709:range=tv",
)
# The quality preserves the dithering of dark backgrounds, which would otherwise show blocks and
# bands; aq-mode 3 gives dark areas more bits.
X264 = ("-preset", "medium", "-crf", "18", "-x264-params", "aq-mode=3", "-movflags", "+faststart")
VP9 = ("-crf", "16", "-b:v", "0", "-deadline", "good", "-cpu-used", "4", "-tile-columns", "2")
# One palette for a whole GIF, computed from samples that precede its first frame. With a palette
# for each frame, all pixels would change between frames, and files would be seven times as large.
PALETTE = (
    "split[sampled][all];[sampled]trim=end_frame={0},palettegen[palette];"
    "[all]trim=start_frame={0},setpts=PTS-STARTPTS[film];"
    "[film][palette]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle"
)
# Equal pictures give equal bytes: no version or date is written, and threads are a fixed number.
REPRODUCIBLE = (
    *("-threads", "4", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1"),
)


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Write H.264 for the suffixes .mp4 and .mov, or VP9 for .webm.

    Raises PlayerError for odd sizes, which H.264 does not support.
    """
    (width, height), webm = film.size, path.suffix.lower() == ".webm"
    if not webm and (width % 2 or height % 2):
        raise PlayerError(
            f"sides of H.264 films are even numbers, not {width}x{height}; "
            f"use --size {width + width % 2}x{height + height % 2}."
        )
    codec, options = ("libvpx-vp9", VP9) if webm else ("libx264", X264)
    with closing(film.pictures(clip, progress)) as pictures:
        encode(pictures, film.frame_count(clip), film, path, codec, [*options, *BT709])


def write_gif(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Write a GIF that loops. Raises PlayerError if its frame rate is too high."""
    if film.fps > MAX_GIF_FPS:
        raise PlayerError(f"a gif shows at most {MAX_GIF_FPS} frames a second, not {film.fps}.")
    days = film.days(clip)
    samples = tuple(days[:: max(1, len(days) // PALETTE_SAMPLES)])
    arguments = ("-vf", PALETTE.format(len(samples)), "-loop", "0", "-pix_fmt", "pal8")
    sampled = replace(film, at=samples, every=None).pictures(clip, lambda done, total: None)
    with closing(sampled), closing(film.pictures(clip, progress)) as frames:
        encode(chain(sampled, frames), len(days), film, path, "gif", arguments)


def encode(
    pictures: Iterable[NDArray[np.uint8]],
    count: int,
    film: Film,
    path: Path,
    codec: str,
    arguments: Sequence[str],
) -> None:
    """Encode pictures by ffmpeg, and check that the file contains all of them.

    pictures:         (height, width, 4) uint8 arrays of the film's size, `count` in all.
    codec, arguments: name of the encoder, and options of ffmpeg.

    Raises PlayerError if ffmpeg is missing or fails.
    """
    from imageio_ffmpeg import count_frames_and_secs, get_ffmpeg_exe, write_frames

    # imageio-ffmpeg would warn if an export is stopped before its first picture.
    logging.getLogger("imageio_ffmpeg").setLevel(logging.ERROR)
    file = str(path.absolute())
    frames = write_frames(
        file,
        film.size,
        pix_fmt_in="rgba",
        fps=film.fps,
        quality=None,
        codec=codec,
        macro_block_size=1,
        ffmpeg_log_level="quiet",
        output_params=[*arguments, *REPRODUCIBLE],
    )
    try:
        next(frames)
    except (RuntimeError, OSError):
        raise PlayerError(
            "no ffmpeg was found; install the package imageio-ffmpeg, or ffmpeg itself."
        ) from None
    with closing(frames):
        for picture in pictures:
            try:
                frames.send(np.ascontiguousarray(picture))
            except OSError:  # ffmpeg has ended, with fewer frames than were sent
                break
    try:
        written, _ = count_frames_and_secs(file)  # imageio-ffmpeg hides the exit code
    except RuntimeError:
        written = 0
    if written != count:
        raise write_error(path, get_ffmpeg_exe())
