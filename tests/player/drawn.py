"""Pictures that a renderer makes of a clip, as arrays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from player.rendering.renderer import Renderer
from player.view.camera import Camera, as_tuple
from player.view.style import Style
from player.window.viewports import Viewports

Picture = NDArray[np.integer]


def on_cpu(context: moderngl.Context) -> bool:
    """Whether OpenGL is a program here (Mesa's software renderers), and no GPU."""
    name = str(context.info["GL_RENDERER"]).lower()
    return any(known in name for known in ("llvmpipe", "softpipe", "swiftshader"))


def fitted(bounds: Sequence[NDArray[np.floating]], up: str = "z", aspect: float = 16 / 9) -> Camera:
    """A camera that sees the box between two corners from every yaw."""
    corners = np.array(bounds, float)
    middle = corners.mean(axis=0)
    radius = max(float(np.linalg.norm(corners[0] - middle)), 1e-6)
    return Camera(as_tuple(middle), up=up, radius=radius).fitted_to_turns(corners, aspect)


def camera_at(clip: Clip, size: tuple[int, int], yaw: float, pitch: float) -> Camera:
    """The whole plant from a direction, in degrees and radians above the horizon."""
    camera = fitted(clip.bounds, clip.up, size[0] / size[1])
    return replace(camera, yaw=math.radians(yaw), pitch=pitch)


def read_pixels(framebuffer: moderngl.Framebuffer) -> Picture:
    """(height, width, 3) int, bottom row first."""
    pixels = np.frombuffer(framebuffer.read(components=3, alignment=1), np.uint8)
    return pixels.reshape(framebuffer.height, framebuffer.width, 3).astype(int)


def window_pixels(
    context: moderngl.Context, viewports: Viewports, size: tuple[int, int]
) -> Picture:
    """(height, width, 3) int, bottom row first: what a window shows of plants."""
    framebuffer = context.simple_framebuffer(size, 3)
    viewports.blit(framebuffer)
    return read_pixels(framebuffer)


def drawn(
    context: moderngl.Context,
    clip: Clip,
    day: float,
    camera: Camera,
    size: tuple[int, int],
    style: Style | None = None,
    *,
    supersample: int = 1,
    stride: int = 1,
    **renderer_options: Any,
) -> Picture:
    """(height, width, 3) int, bottom row first: what a new renderer draws."""
    renderer = Renderer(context, clip, supersample, **renderer_options)
    framebuffer = context.simple_framebuffer(size, 3)
    whole = renderer.draw(framebuffer, day, camera, style or Style(), size, stride=stride)
    assert whole == (stride == 1)
    assert context.error == "GL_NO_ERROR"
    pixels = read_pixels(framebuffer)
    renderer.release()
    return pixels
