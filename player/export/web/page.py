"""Export of a clip as one HTML file that needs no server and no other files."""

import base64
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from functools import partial
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import shaders
from gclip import Clip
from gclip.evaluate import LITTER_FADE, newborn, srgb_to_linear
from player.errors import PlayerError
from player.export.film import Film, Progress
from player.export.web.encode import pack
from player.rendering import ground
from player.rendering.point_cloud import PALETTE_WIDTH
from player.rendering.points import MAX_RADIUS_PX
from player.rendering.renderer import MIN_POINT_PX, SPLAT_RADIUS, scene_radius, splat_edge
from player.rendering.splat_radius import ClosingDistances
from player.view.camera import FITTED_SHARE, MAX_PITCH, Camera, sampled_positions
from player.view.colors import DIMMED_SHARE, Colors, format_number
from player.view.playback import END_PAUSE, Timeline
from player.view.style import GROUNDS, ColorMode
from shaders.effects import EFFECTS
from traits.curves import curve_names, curve_svg, trait_curves
from traits.dates import date_at, elapsed, short_dates
from traits.upright import upright_axes

SHADERS = (
    *("splat.vert", "splat_depth.frag", "splat_sum.frag", "shadow.vert", "shadow.frag"),
    *("fullscreen.vert", "splat_resolve.frag", "bilateral.frag", "shade.frag", "blur.frag"),
    *("ground.frag", "picture.frag"),
)
DATE_STEPS = 1000  # times of the series for which the displayed date is computed
MIN_DATE_DISTANCE = 8.0  # between scans whose dates fit side by side, in % of the timeline
MAX_ORGANS = 2000  # number of organs that are listed
MAX_CURVES = 100  # number of organs whose traits are plotted
FRAME_HEIGHT = 540  # pixels of a frame in a notebook
MAX_STRING = 1 << 29  # characters of an encoded interval, the limit of strings in browsers


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Write the page in the film's style. Raises PlayerError if an interval is too large."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(_page(clip, film, progress))


def iframe(clip: Clip, height: int = FRAME_HEIGHT) -> str:
    """Embed the page of a clip in an HTML frame, for notebooks.

    Parameters
    ----------
    clip : gclip.Clip
    height : int
        Of the frame in pixels; its width is that of the notebook.

    Returns
    -------
    str
        An ``<iframe>`` element that needs no other files.
    """
    page = escape("".join(_page(clip, Film(name="plant"), lambda done, total: None)))
    return f'<iframe srcdoc="{page}" width="100%" height="{height}" style="border: 0"></iframe>'


def _page(clip: Clip, film: Film, progress: Progress) -> Iterator[str]:
    """Generate the text of the page."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    packed, total = [], len(clip.intervals)
    progress(0, total)
    for done, interval in enumerate(clip.intervals, start=1):
        packed.append(pack(interval, clip.spacing))
        if 4 * len(packed[-1][0]) > 3 * MAX_STRING:
            raise PlayerError(f"interval {done} is too large for a page; bake with --voxel SIZE.")
        progress(done, total)
    environment = Environment(
        loader=PackageLoader("player.export", "web"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["css"] = _css
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "allow_nan": False}
    first, last = clip.times[0], clip.times[-1]
    positions = [100.0 * (time - first) / (last - first) for time in clip.times]
    yield from environment.get_template("page.html").generate(
        clip=clip,
        film=film,
        scale=Colors(clip).value_range(film.style),
        marks=zip(positions, short_dates([scan.date for scan in clip.scans]), strict=True),
        crowded=min(after - before for before, after in pairwise(positions)) < MIN_DATE_DISTANCE,
        organs=clip.track_table[:MAX_ORGANS],
        effects=EFFECTS,
        date=partial(date_at, clip.scans),
        about=_about(clip, film, [layout for _, layout in packed]),
        shaders={name: shaders.resolved(name) for name in SHADERS},
        intervals=(base64.b64encode(data).decode("ascii") for data, _ in packed),
    )


def _about(clip: Clip, film: Film, layouts: list[dict[str, Any]]) -> dict[str, Any]:
    """Data of the page besides the points, which become properties of `Clip` in web/clip.js."""
    closing = ClosingDistances(clip)
    to_square, half_side = ground.floor_square(clip)
    home = Camera.home(clip, film.aspect)
    return {
        "times": clip.times,
        "moments": _moments(clip),
        "points": [scan.points for scan in clip.scans],
        "colored": clip.has_colors,
        "tracks": srgb_to_linear(clip.palette[:, :3] / 255.0).round(5).tolist(),
        "newborn": [[*newborn(clip, k).items()] for k in range(len(clip.intervals))],
        "intervals": layouts,
        "litterFade": LITTER_FADE,
        "clock": {"speed": Timeline.of(clip.times).days_per_second, "pause": END_PAUSE},
        "palette": {"width": PALETTE_WIDTH, "grey": shaders.GREY, "dimmed": DIMMED_SHARE},
        "nothing": shaders.NOTHING,
        "coverage": [closing.at(time) for time in clip.times],
        "splat": {"radii": SPLAT_RADIUS, "smallest": MIN_POINT_PX, "small": MAX_RADIUS_PX},
        "uniforms": {
            "edge": splat_edge(clip),
            "lift": 0.0,
            "scene_radius": scene_radius(clip),
            "perspective": 1.0,
            "transparent": False,
            **film.style.uniforms,
        },
        "shadow": {
            "side": ground.SHADOW_SIZE,
            "points": ground.SHADOW_POINTS,
            "contact_height": ground.CONTACT_HEIGHT * half_side,
            "texel": 2 * half_side / ground.SHADOW_SIZE,
            "toSquare": to_square.T.ravel().tolist(),
        },
        "groundSize": ground.BACKGROUND_SIZE,
        "home": asdict(home) | {"aspect": _narrowest(clip, home), "max_pitch": MAX_PITCH},
        "plotted": curve_names(clip),
        "curves": _curves(clip),
        "axes": upright_axes(clip.up).tolist(),
        "look": {
            "light": film.style.ground == "light",
            "byTrack": film.style.color_by == ColorMode.TRACK,
            "turning": film.turning,
            "pointSize": film.style.point_size,
        },
        "grounds": {name: asdict(ground) for name, ground in GROUNDS.items()},
    }


def _narrowest(clip: Clip, home: Camera) -> float:
    """Width divided by height of the narrowest picture that the home view still fits."""
    points = sampled_positions(clip) @ upright_axes(clip.up)
    right, _, _, depth = home.matrix(1.0) @ np.column_stack([points, np.ones(len(points))]).T
    return float(np.abs(right / depth).max()) / FITTED_SHARE


def _moments(clip: Clip) -> list[tuple[float, str, str]]:
    """Times at which the displayed date changes, with date and time since the first scan."""
    days = np.union1d(np.linspace(clip.times[0], clip.times[-1], DATE_STEPS), clip.times).tolist()
    unit = clip.time_unit
    texts = [(day, date_at(clip.scans, day), elapsed(clip.scans, day, unit)) for day in days]
    return texts[:1] + [after for before, after in pairwise(texts) if before[1:] != after[1:]]


def _curves(clip: Clip) -> dict[str, tuple[str, str]]:
    """Caption and SVG of each plot by "TRACK TRAIT"."""
    plots, span, table = {}, (clip.times[0], clip.times[-1]), clip.track_table[:MAX_CURVES]
    for curve in trait_curves(clip, range(len(table))):
        low, high = format_number(curve.bottom), format_number(max(curve.values))
        caption = f"{curve.trait}, {low} to {high}{curve.unit}"
        svg = curve_svg(curve, span, _css(table[curve.track].color))
        plots[f"{curve.track} {curve.trait}"] = caption, svg
    return plots


def _css(color: Sequence[int]) -> str:
    return "rgb({},{},{})".format(*color)
