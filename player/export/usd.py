"""Export of the growing plant as an OpenUSD stage: points with time samples.

Each group of an interval is a Points prim that is visible during the interval. USD interpolates
linearly between time samples, so straight paths need two samples and curved paths more.
"""

import os
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Group, Motion
from gclip.evaluate import Layer, evaluate_layer, srgb_to_linear
from player.errors import PlayerError
from player.export.film import Film, Progress
from player.export.gltf import METERS
from player.output_names import write_error
from traits.upright import upright_axes

ZIP_EPOCH = datetime(1980, 1, 1)  # modification time in packages, for reproducible files
CURVED_SAMPLES = 17  # time samples of an interval if movers follow curves or fall


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Write the plant; time codes are frames of the film, counted from 0."""
    try:
        from pxr import Tf, UsdUtils
    except ImportError:
        raise PlayerError(
            "USD needs OpenUSD's library: pip install 'plant-growth-clips[usd]' brings it."
        ) from None
    if not str(path).isprintable():
        raise PlayerError(f"{path.name}: OpenUSD writes files of plain names only.")
    is_package = path.suffix.lower() == ".usdz"
    stage = path.with_name("plant.usdc") if is_package else path
    try:
        _write_stage(clip, film, stage, progress)
        if is_package:
            os.utime(stage, (ZIP_EPOCH.timestamp(),) * 2)
            if not UsdUtils.CreateNewUsdzPackage(str(stage), str(path)):
                raise write_error(path, "OpenUSD")
    except Tf.ErrorException:
        raise write_error(path, "OpenUSD") from None


def _write_stage(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    from pxr import Gf, Sdf, Usd, UsdGeom

    total = len(clip.intervals)
    frames = film.length(clip) * film.fps
    rate = frames / (clip.times[-1] - clip.times[0])
    stage = Usd.Stage.CreateNew(str(path))
    stage.SetStartTimeCode(0.0)
    stage.SetEndTimeCode(frames)
    stage.SetTimeCodesPerSecond(film.fps)
    stage.SetFramesPerSecond(film.fps)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y if clip.up == "y" else UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, METERS.get(clip.unit, 1.0))
    root = UsdGeom.Xform.Define(stage, "/plant")
    root.AddTransformOp().Set(Gf.Matrix4d(*_root_matrix(clip).T.ravel().tolist()))
    root.GetPrim().SetMetadata(Sdf.PrimSpec.DocumentationKey, film.title or film.name)
    stage.SetDefaultPrim(root.GetPrim())
    progress(0, total)
    for index, interval in enumerate(clip.intervals):
        begin = (interval.start - clip.times[0]) * rate
        length = (interval.end - interval.start) * rate
        for group in interval.groups:
            _add_group(stage, clip, index, group, begin, length)
        progress(index + 1, total)
    stage.GetRootLayer().Save()


def _add_group(
    stage: Any, clip: Clip, index: int, group: Group, begin: float, length: float
) -> None:
    """Add a prim with positions and colours over time, labels, and visibility."""
    from pxr import Sdf, UsdGeom, Vt

    if group.motion is Motion.REMOVE or not group.count:
        return
    prim = UsdGeom.Points.Define(stage, f"/plant/interval_{index:04d}_{group.motion.value}")
    positions, extents = prim.CreatePointsAttr(), prim.CreateExtentAttr()
    display_colors = prim.CreateDisplayColorPrimvar(UsdGeom.Tokens.vertex)
    falls = group.motion is Motion.FALL
    straight = clip.intervals[index].degree == 1 and not falls
    for share in np.linspace(0.0, 1.0, 2 if straight else CURVED_SAMPLES).tolist():
        layer = Layer(index, group, share**2 if falls else share, share, alpha=1.0)
        local, colors, tracks = evaluate_layer(clip, layer)
        time, points = begin + share * length, Vt.Vec3fArray.FromNumpy(local)
        positions.Set(points, time)
        extents.Set(UsdGeom.PointBased.ComputeExtent(points), time)
        if share in (0.0, 1.0):
            light = srgb_to_linear(colors[:, :3] / 255.0).astype(np.float32)
            display_colors.Set(Vt.Vec3fArray.FromNumpy(light), time)
    prim.CreateWidthsAttr(Vt.FloatArray([2.0 * clip.spacing]))
    prim.SetWidthsInterpolation(UsdGeom.Tokens.constant)
    label = UsdGeom.PrimvarsAPI(prim).CreatePrimvar(
        "label", Sdf.ValueTypeNames.IntArray, UsdGeom.Tokens.vertex
    )
    label.Set(Vt.IntArray.FromNumpy(tracks.astype(np.int32)))
    if group.motion is Motion.FADE:
        opacity = prim.CreateDisplayOpacityPrimvar(UsdGeom.Tokens.constant)
        opacity.Set(Vt.FloatArray([1.0]), begin)
        opacity.Set(Vt.FloatArray([0.0]), begin + length)

    visibility = prim.CreateVisibilityAttr()
    if begin > 0.0:
        visibility.Set(UsdGeom.Tokens.invisible, 0.0)
    visibility.Set(UsdGeom.Tokens.inherited, begin)
    if index < len(clip.intervals) - 1 or group.motion is not Motion.MOVE:
        visibility.Set(UsdGeom.Tokens.invisible, begin + length)


def _root_matrix(clip: Clip) -> NDArray[np.float64]:
    """(4, 4) matrix from local coordinates to the stage's, whose up axis is y or z."""
    matrix = np.eye(4)
    if clip.up != "y":
        matrix[:3, :3] = upright_axes(clip.up)
    matrix[:3, 3] = matrix[:3, :3] @ np.asarray(clip.origin)
    return matrix
