"""A film: which day each of its frames shows, from where it is seen, and how far drawing is."""

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

Progress = Callable[[int, int], None]  # steps done, steps in all

SECONDS_AN_INTERVAL = 1.5
SHORTEST, LONGEST = 4.0, 30.0  # seconds of a film whose length was not asked for
HELD_FIRST, HELD_LAST = 0.04, 0.12  # shares of the film that rest on the first and the last scan


@dataclass(frozen=True)
class Film:
    """A film, or with `at` a still picture."""

    size: tuple[int, int] = (1280, 720)  #: (width, height) in pixels
    fps: int = 30  #: frames a second
    seconds: float | None = None  #: length; None fits it to the number of scans
    turning: bool = False  #: the camera goes round the plant once, and ends where it began
    style: Style = field(default_factory=Style)
    #: the days of still pictures, one each; empty films real time, first to last scan
    at: tuple[float, ...] = ()
    #: the time between two frames, in the clip's unit, from the first scan on; None spreads the
    #: frames over the film's length
    every: float | None = None
    title: str = ""  #: written into the picture or on the page, "" where nothing was said
    #: what else is written into the picture
    annotations: Annotations = field(default_factory=Annotations)
    transparent: bool = False  #: the plant alone, on no ground
    name: str = "plant"  #: what the plant is called where it needs a name: its clip's
    path: CameraPath | None = None  #: the camera on every day; None shows the whole plant

    @property
    def aspect(self) -> float:
        return self.size[0] / self.size[1]

    def length(self, clip: Clip) -> float:
        """In seconds."""
        if self.every is not None:
            return self.frame_count(clip) / self.fps
        if self.seconds is not None:
            return self.seconds
        return min(max(SECONDS_AN_INTERVAL * len(clip.intervals), SHORTEST), LONGEST)

    def frame_count(self, clip: Clip) -> int:
        if self.every is not None:
            return 1 + math.floor((clip.times[-1] - clip.times[0]) / self.every + 1e-9)
        return len(self.at) or max(1, round(self.length(clip) * self.fps))

    def days(self, clip: Clip) -> list[float]:
        """The day of every frame: real time, with a rest on the first and the last scan."""
        if self.at:
            return list(self.at)
        count, ends = self.frame_count(clip), (clip.times[0], clip.times[-1])
        if self.every is not None:
            return [min(ends[0] + i * self.every, ends[1]) for i in range(count)]
        shares = np.linspace(1.0, 0.0, count)[::-1]  # of the film; one frame shows the last scan
        return np.interp(shares, (HELD_FIRST, 1.0 - HELD_LAST), ends).tolist()

    def frames(self, clip: Clip, offscreen: Offscreen) -> Iterator[NDArray]:
        """(height, width, 4) uint8 pictures, one after the other; while film and camera rest, the
        same one comes again, undrawn.

        Raises PlayerError for a legend of colours that mean nothing: the scans' own.
        """
        values = Colors(clip).color_scale(self.style) if self.annotations.legend else None
        if self.annotations.legend and self.style.color_mode(clip) == "scan":
            raise PlayerError(
                "--legend explains colours of organs and values, not the scans' own; "
                "add --color track, age, speed, height or error, or leave it out."
            )
        views = zip(self.days(clip), self.cameras(clip), strict=True)
        for (day, camera), resting in groupby(views):
            plain = offscreen.picture(day, camera, self.style, self.transparent)
            picture = annotated(plain, day, camera, self, clip, values)
            for _ in resting:
                yield picture

    def pictures(self, clip: Clip, progress: Progress) -> Generator[NDArray, None, None]:
        """The frames, each drawn as it is asked for.

        OpenGL starts with the first one: an encoder is started before, since drivers have threads
        and locks that a fork may hang on (imageio-ffmpeg, issue 58).
        """
        total = self.frame_count(clip)
        with Offscreen(clip, self.size) as offscreen:
            progress(0, total)
            for done, picture in enumerate(self.frames(clip, offscreen), start=1):
                yield picture
                progress(done, total)

    def cameras(self, clip: Clip) -> list[Camera]:
        """From where each frame is seen."""
        days, home = self.days(clip), Camera.home(clip, self.aspect, turning=self.turning)
        starts = [self.path.at(day) if self.path else home for day in days]
        turn = 2.0 * math.pi / len(days) if self.turning else 0.0
        return [camera.orbit(turn * index, 0.0) for index, camera in enumerate(starts)]
