"""Films and still pictures of a clip: day and camera of each frame, and the frames themselves."""

import math
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.errors import PlayerError
from player.export.annotations import annotated
from player.rendering.headless import Offscreen
from player.view.annotations import Annotations
from player.view.camera import Camera
from player.view.camera_animation import CameraPath
from player.view.colors import Colors
from player.view.style import Style

Progress = Callable[[int, int], None]  # is called with the number of steps done and of all steps

SECONDS_PER_INTERVAL = 1.5  # of a film without a given length
MIN_SECONDS, MAX_SECONDS = 4.0, 30.0  # of such a film
FIRST_SCAN_SHARE, LAST_SCAN_SHARE = 0.04, 0.12  # of the film, that show the first and last scan


@dataclass(frozen=True)
class Film:
    """What to export: a film of the whole series, or still pictures of the days `at`."""

    size: tuple[int, int] = (1280, 720)  #: (width, height) in pixels
    fps: int = 30  #: frames per second
    seconds: float | None = None  #: length; by default it depends on the number of scans
    turning: bool = False  #: whether the camera makes one turn about the plant
    style: Style = field(default_factory=Style)
    at: tuple[float, ...] = ()  #: days of still pictures; empty for a film
    every: float | None = None  #: time between frames in the clip's unit, instead of a length
    title: str = ""  #: written into pictures and pages
    annotations: Annotations = field(default_factory=Annotations)
    transparent: bool = False  #: whether to leave out the background
    name: str = "plant"  #: name of the plant in files without a title
    path: CameraPath | None = None  #: of the camera; by default the whole plant is shown

    @property
    def aspect(self) -> float:
        """Width divided by height."""
        return self.size[0] / self.size[1]

    def length(self, clip: Clip) -> float:
        """Length of the film in seconds."""
        if self.every is not None:
            return self.frame_count(clip) / self.fps
        if self.seconds is not None:
            return self.seconds
        return min(max(SECONDS_PER_INTERVAL * len(clip.intervals), MIN_SECONDS), MAX_SECONDS)

    def frame_count(self, clip: Clip) -> int:
        if self.every is not None:
            return 1 + math.floor((clip.times[-1] - clip.times[0]) / self.every + 1e-9)
        return len(self.at) or max(1, round(self.length(clip) * self.fps))

    def days(self, clip: Clip) -> list[float]:
        """The day of each frame; a film stays at the first and at the last scan for a while."""
        if self.at:
            return list(self.at)
        count, ends = self.frame_count(clip), (clip.times[0], clip.times[-1])
        if self.every is not None:
            return [min(ends[0] + i * self.every, ends[1]) for i in range(count)]
        shares = np.linspace(1.0, 0.0, count)[::-1]  # a single frame shows the last scan
        return np.interp(shares, (FIRST_SCAN_SHARE, 1.0 - LAST_SCAN_SHARE), ends).tolist()

    def frames(self, clip: Clip, offscreen: Offscreen) -> Iterator[NDArray]:
        """Yield (height, width, 4) uint8 sRGB frames; equal consecutive frames are drawn once.

        Raises PlayerError for a legend if the clip is shown in the colours of its scans.
        """
        values = Colors(clip).value_range(self.style) if self.annotations.legend else None
        if self.annotations.legend and self.style.color_mode(clip) == "scan":
            raise PlayerError(
                "--legend explains colours of organs and values, not the scans' own; "
                "add --color track or another one, or leave --legend out."
            )
        views = zip(self.days(clip), self.cameras(clip), strict=True)
        for (day, camera), repeats in groupby(views):
            plain = offscreen.picture(day, camera, self.style, self.transparent)
            picture = annotated(plain, day, camera, self, clip, values)
            for _ in repeats:
                yield picture

    def pictures(self, clip: Clip, progress: Progress) -> Generator[NDArray, None, None]:
        """Yield the frames, each drawn when it is requested, and report progress.

        OpenGL is started with the first frame, after an encoder's process: drivers have threads and
        locks, with which a later fork may hang (imageio-ffmpeg, issue 58).
        """
        total = self.frame_count(clip)
        with Offscreen(clip, self.size) as offscreen:
            progress(0, total)
            for done, picture in enumerate(self.frames(clip, offscreen), start=1):
                yield picture
                progress(done, total)

    def cameras(self, clip: Clip) -> list[Camera]:
        """The camera of each frame."""
        days, home = self.days(clip), Camera.home(clip, self.aspect, turning=self.turning)
        starts = [self.path.at(day) if self.path else home for day in days]
        turn = 2.0 * math.pi / len(days) if self.turning else 0.0
        return [camera.orbit(turn * index, 0.0) for index, camera in enumerate(starts)]
