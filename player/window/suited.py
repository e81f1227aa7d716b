"""A scene as the clips allow it that a window shows: at first, dropped on it, or baked anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from player.view.camera_animation import CameraPath
from player.view.choices import Compare
from player.view.state import Scene
from player.window.opened_clip import Shown


def suited(scene: Scene, shown: Sequence[Shown]) -> Scene:
    """What these clips don't have is no longer shown, picked or compared with."""
    clip, style = shown[0].clip, scene.style
    organs, compare = len(clip.track_table), scene.compare
    if scene.organs != organs and style.marked:
        scene = scene.styled(scene.notice, picked=None, alone=None, hidden=frozenset())
    if style.color_by == "error" and not clip.held_out:
        scene = scene.styled(scene.notice, color_by="auto")
    if len(shown) != scene.clips:
        compare = Compare.BESIDE if len(shown) > 1 else Compare.OFF
    return replace(
        scene,
        has_colors=clip.has_colors,
        has_errors=bool(clip.held_out),
        organs=organs,
        clips=len(shown),
        compare=compare,
    )


def reopened(scene: Scene, shown: Sequence[Shown], fresh: bool) -> Scene:
    """The scene with other clips (fresh), or with the same ones as they were baked anew: then on
    the same day, and with the same camera path.
    """
    times = tuple(shown[0].clip.times)
    timeline = replace(scene.timeline, times=times, begin=None, end=None)
    timeline = timeline.at(times[0] if fresh else timeline.day)
    path = CameraPath() if fresh else scene.path
    following = bool(path and scene.following)
    told = f"Opened {shown[0].name}" if fresh else "Baked anew: loaded again"
    return suited(replace(scene, timeline=timeline, path=path, following=following), shown).told(
        told
    )
