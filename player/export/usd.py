"""The growing plant as an OpenUSD stage: points with time samples.

Each interval has movers of its own, so each group of them is a Points prim of its own, visible
while its time lasts. Between time samples USD interpolates linearly, so straight paths need two
samples and curved ones some more.
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
from player.output_names import failure
from player.view.camera import axes

ZIP_EPOCH = datetime(1980, 1, 1)  # a package tells when its stage was written
CURVED_SAMPLES = 17  # an interval, where movers go along curves or fall


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Write the plant; its time codes are the film's frames, from 0."""
    try:
        from pxr import Tf, UsdUtils
    except ImportError:
        raise PlayerError(
            "USD needs OpenUSD's library: pip install 'plant-growth-clips[usd]' brings it."
        ) from None
    if not str(path).isprintable():
        raise PlayerError(f"{path.name}: OpenUSD writes files of plain names only.")
    packed = path.suffix.lower() == ".usdz"
    stage = path.with_name("plant.usdc") if packed else path
    try:
        _write_stage(clip, film, stage, progress)
        if packed:
            os.utime(stage, (ZIP_EPOCH.timestamp(),) * 2)
            if not UsdUtils.CreateNewUsdzPackage(str(stage), str(path)):
                raise failure(path, "OpenUSD")
    except Tf.ErrorException:
        raise failure(path, "OpenUSD") from None


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
    root.AddTransformOp().Set(Gf.Matrix4d(*_placed(clip).T.ravel().tolist()))
    root.GetPrim().SetMetadata(Sdf.PrimSpec.DocumentationKey, film.title or film.name)
    stage.SetDefaultPrim(root.GetPrim())
    progress(0, total)
    for index, interval in enumerate(clip.intervals):
        begin = (interval.start - clip.times[0]) * rate
        length = (interval.end - interval.start) * rate
        for group in interval.groups:
            _add(stage, clip, index, group, begin, length)
        progress(index + 1, total)
    stage.GetRootLayer().Save()


def _add(stage: Any, clip: Clip, index: int, group: Group, begin: float, length: float) -> None:
    """One prim: places and colours over time, labels, and when it is seen."""
    from pxr import Sdf, UsdGeom, Vt

    if group.motion is Motion.REMOVE or not group.count:
        return
    prim = UsdGeom.Points.Define(stage, f"/plant/interval_{index:04d}_{group.motion.value}")
    places, extents = prim.CreatePointsAttr(), prim.CreateExtentAttr()
    paint = prim.CreateDisplayColorPrimvar(UsdGeom.Tokens.vertex)
    falls = group.motion is Motion.FALL
    straight = clip.intervals[index].degree == 1 and not falls
    for share in np.linspace(0.0, 1.0, 2 if straight else CURVED_SAMPLES).tolist():
        layer = Layer(index, group, share**2 if falls else share, share, alpha=1.0)
        local, colors, tracks = evaluate_layer(clip, layer)
        time, points = begin + share * length, Vt.Vec3fArray.FromNumpy(local)
        places.Set(points, time)
        extents.Set(UsdGeom.PointBased.ComputeExtent(points), time)
        if share in (0.0, 1.0):
            light = srgb_to_linear(colors[:, :3] / 255.0).astype(np.float32)
            paint.Set(Vt.Vec3fArray.FromNumpy(light), time)
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

    seen = prim.CreateVisibilityAttr()
    if begin > 0.0:
        seen.Set(UsdGeom.Tokens.invisible, 0.0)
    seen.Set(UsdGeom.Tokens.inherited, begin)
    if index < len(clip.intervals) - 1 or group.motion is not Motion.MOVE:
        seen.Set(UsdGeom.Tokens.invisible, begin + length)


def _placed(clip: Clip) -> NDArray[np.float64]:
    """(4, 4) from local coordinates to the stage's: y or z up as it is, else turned to z up."""
    matrix = np.eye(4)
    if clip.up != "y":
        matrix[:3, :3] = axes(clip.up)
    matrix[:3, 3] = matrix[:3, :3] @ np.asarray(clip.origin)
    return matrix
