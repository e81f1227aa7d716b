"""One HTML file that shows the growing plant: no server, no other file, nothing from outside."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from player.atomic_write import whole_file
from player.errors import PlayerError
from player.export.film import Film
from player.export.web.encode import Packed, pack
from player.rendering.splat_radius import ClosingDistances
from player.view.camera import Camera, axes, outline
from player.view.colors import Colors, resolved_color_mode
from player.view.dates import short_dates
from player.view.style import GROUNDS, ColorMode
from shaders import web_sources

if TYPE_CHECKING:
    from collections.abc import Callable

    from gclip import Clip

SCRIPTS = ("clip.js", "timeline.js", "camera.js", "renderer.js", "page.js")
CORNERS = 96  # outermost points that the browser fits its view to
LARGEST = 1 << 29  # characters of one interval: browsers hold no longer strings


def write(clip: Clip, film: Film, path: Path, progress: Callable[[int, int], None]) -> None:
    """Write the page; it opens with the film's look. Raises PlayerError where it can't be."""
    total = len(clip.intervals)
    progress(0, total)
    packed = []
    for done, interval in enumerate(clip.intervals, start=1):
        packed.append(pack(interval, clip.spacing))
        if 4 * len(packed[-1].data) > 3 * LARGEST:
            raise PlayerError(
                f"{path.name}: interval {done} is too large for a page; bake with --voxel SIZE."
            )
        progress(done, total)
    with whole_file(path) as part, part.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(render(clip, film, film.title or film.name, packed))


def render(clip: Clip, film: Film, title: str, packed: list[Packed]) -> Iterator[str]:
    """The page's text, piece by piece."""
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("player.export", "web"), autoescape=True, undefined=StrictUndefined
    )
    environment.trim_blocks = environment.lstrip_blocks = True
    return environment.get_template("page.html").generate(
        title=title,
        ground=film.style.ground,
        style=Markup(_read("page.css")),
        script=Markup("\n".join(_read(name) for name in SCRIPTS)),
        clip=embedded(_about(clip, film, title, packed)),
        shaders=embedded(web_sources()),
        intervals=(base64.b64encode(one.data).decode("ascii") for one in packed),
    )


def embedded(value: Any) -> Any:
    """JSON that can stand inside <script>: no character in it can end the element or begin a tag.

    Names come from files that anyone may have written.
    """
    from markupsafe import Markup

    text = json.dumps(value, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def _about(clip: Clip, film: Film, title: str, packed: list[Packed]) -> dict[str, Any]:
    """What the page knows besides the movers; read in web/clip.js."""

    closing, dates = ClosingDistances(clip), [scan.date for scan in clip.scans]
    home, points = Camera.home(clip, film.aspect), outline(clip)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    spread = float(np.hypot(*(points[:, :2] - middle[:2]).T).max())
    return {
        "title": title,
        "up": clip.up,
        "timeUnit": clip.time_unit,
        "times": clip.times,
        "dates": dates,
        "shortDates": short_dates(dates),
        "points": [scan.points for scan in clip.scans],
        "colored": clip.has_colors,
        "tracks": [
            {"name": t.name, "color": t.color, "born": t.born, "lost": t.lost}
            for t in clip.track_table
        ],
        "intervals": [
            {
                "start": interval.start,
                "end": interval.end,
                "count": len(interval),
                "degree": interval.degree,
                "groups": [
                    {"first": g.first, "count": g.count, "motion": str(g.motion)}
                    for g in interval.groups
                ],
                "low": one.low,
                "step": one.step,
                "trackBytes": one.track_bytes,
                "colored": one.colored,
            }
            for interval, one in zip(clip.intervals, packed, strict=True)
        ],
        "closing": [closing.at(k, 0.0) for k in range(len(clip.intervals))]
        + [closing.at(len(clip.intervals) - 1, 1.0)],
        "outline": _corners(points, clip.up),
        "radius": home.radius,
        "middle": middle.tolist(),
        "floor": clip.floor,
        "floorSide": 1.7 * max(spread, 0.5 * float(high[2] - low[2]), 1e-9),
        "home": {
            "target": home.target,
            "distance": home.distance,
            "yaw": home.yaw,
            "pitch": home.pitch,
            "fieldOfView": home.field_of_view,
        },
        "scale": _scale(clip, film),
        "look": {
            "light": film.style.ground == "light",
            "byTrack": film.style.color_by == "track",
            "turning": film.turning,
            "pointSize": film.style.point_size,
            "eyeDome": film.style.eye_dome,
            "depthCue": 0.45 if film.style.depth_cue else 0.0,
            "floor": 1.0 if film.style.show_ground else 0.0,
        },
        "grounds": {name: _ground(asdict(ground)) for name, ground in GROUNDS.items()},
    }


def _scale(clip: Clip, film: Film) -> dict[str, Any] | None:
    """What the movers' own colours mean, where they are those of a value: errors."""
    colors, by_error = Colors(clip), resolved_color_mode(clip, film.style) is ColorMode.ERROR
    scale = colors.color_scale(film.style) if by_error else None
    if scale is None:
        return None
    steps = scale.colors()[:: len(scale.colors()) // 16].tolist()
    low, high = scale.ends
    return {
        "title": scale.title,
        "low": low,
        "high": high,
        "colors": [f"rgb({red},{green},{blue})" for red, green, blue in steps],
    }


def _ground(colors: dict[str, Any]) -> dict[str, Any]:
    """A background's colours by the names that shaders/web/picture.frag gives them."""
    plain = ("above", "below", "floor", "shadow")
    return {f"{name}_color" if name in plain else name: color for name, color in colors.items()}


def _corners(points: np.ndarray, up: str) -> list[list[float]]:
    """(n, 3) local coordinates of the outermost of points in the axes of `camera.axes`."""
    directions = np.random.default_rng(0).normal(size=(CORNERS, 3))
    outermost = np.unique(np.argmax(points @ directions.T, axis=0))
    return (points[outermost] @ axes(up)).tolist()


def _read(name: str) -> str:
    return (files("player.export") / "web" / name).read_text("utf-8")
