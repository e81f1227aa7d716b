"""Frame times of animated points in this player and in other libraries.

    python -m bench.peers [--points 1000000] [--size 1280x720] [--frames 7] [--only NAME,...]

Every library draws the same plant from the same camera as plain points, and returns the picture as
an array. The positions of a frame are interpolated with numpy, and passed to the library as its
documentation recommends. Each library runs in a process of its own, and is skipped if it is not
installed or has no display. Wall times are medians over the frames. CPU times are the least of the
frames, over all threads of the process; they depend less on other load. Without a GPU, all of them
draw with Mesa's llvmpipe (pygfx with its lavapipe), which LIBGL_ALWAYS_SOFTWARE=1 enforces.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.synthetic import growing
from gclip.evaluate import bernstein
from player.view.camera import Camera

Draw = Callable[[float], NDArray]  # draws a share of the interval, and returns the picture
POINT_SIZE = 2  # diameter of points in pixels, except in this player
FIELD_OF_VIEW = 28.0  # degrees


class Plant:
    """Curves and colours of the points, and the camera."""

    def __init__(self, count: int, size: tuple[int, int]) -> None:
        self.size = size
        self.clip = growing(count)
        interval = self.clip.intervals[0]
        assert interval.box is not None
        low, step = np.float32(interval.box.low), interval.box.step.astype(np.float32)
        self.curve = [low + step * points.astype(np.float32) for points in interval.curve]
        self.colors = self.clip.palette[interval.tracks]
        camera = Camera.home(self.clip, size[0] / size[1], turning=True)
        self.target, self.eye = np.asarray(camera.target), camera.eye
        self.pose = np.linalg.inv(camera.view())
        self.distance = camera.distance
        self.camera = camera

    def at(self, share: float) -> NDArray[np.float32]:
        """(N, 3) positions at a share of the interval."""
        first, *rest = zip(bernstein(2, share).astype(np.float32), self.curve, strict=True)
        blended = first[0] * first[1]
        for weight, points in rest:
            blended += weight * points
        return blended


def player(plant: Plant, plain: bool) -> Draw:
    """This player, in its default style or (plain) without shading, floor and depth cue."""
    from player.rendering.headless import Offscreen
    from player.view.style import Style

    offscreen = Offscreen(plant.clip, plant.size, supersample=1)
    style = Style(depth_cue=False, shading=0.0, floor=False) if plain else Style()
    return lambda share: offscreen.picture(share, plant.camera, style)


def pyrender(plant: Plant) -> Draw:
    os.environ["PYOPENGL_PLATFORM"] = "egl"
    import pyrender

    scene = pyrender.Scene(bg_color=(0, 0, 0, 1))
    scene.add(pyrender.PerspectiveCamera(np.radians(FIELD_OF_VIEW)), pose=plant.pose)
    renderer = pyrender.OffscreenRenderer(*plant.size, point_size=POINT_SIZE)
    shown: list = []

    def draw(share: float) -> NDArray:
        for node in shown:
            scene.remove_node(node)
        shown[:] = [scene.add(pyrender.Mesh.from_points(plant.at(share), colors=plant.colors))]
        return renderer.render(scene)[0]

    return draw


def vispy(plant: Plant) -> Draw:
    import vispy

    vispy.use(os.environ.get("BENCH_VISPY", "egl"))
    from vispy import scene

    canvas = scene.SceneCanvas(size=plant.size, show=False)
    view = canvas.central_widget.add_view()
    view.camera = scene.TurntableCamera(
        fov=FIELD_OF_VIEW,
        center=tuple(plant.target),
        distance=plant.distance,
        elevation=14,
        azimuth=30,
    )
    markers = scene.visuals.Markers(parent=view.scene)
    colors = plant.colors / np.float32(255)

    def draw(share: float) -> NDArray:
        markers.set_data(pos=plant.at(share), face_color=colors, size=POINT_SIZE, edge_width=0)
        return canvas.render()

    return draw


def pyvista(plant: Plant) -> Draw:
    import pyvista as pv

    plotter = pv.Plotter(off_screen=True, window_size=plant.size)
    cloud = pv.PolyData(plant.at(0.0))
    cloud["rgb"] = plant.colors[:, :3].copy()
    plotter.add_points(cloud, scalars="rgb", rgb=True, point_size=POINT_SIZE, lighting=False)
    plotter.camera_position = [tuple(plant.eye), tuple(plant.target), (0, 0, 1)]
    plotter.camera.view_angle = FIELD_OF_VIEW
    plotter.show(auto_close=False)

    def draw(share: float) -> NDArray:
        cloud.points = plant.at(share)
        plotter.render()
        return plotter.screenshot(return_img=True)

    return draw


def open3d(plant: Plant) -> Draw:
    import open3d as o3d

    rendering = o3d.visualization.rendering
    renderer = rendering.OffscreenRenderer(*plant.size)
    material = rendering.MaterialRecord()
    material.shader, material.point_size = "defaultUnlit", POINT_SIZE
    cloud = o3d.t.geometry.PointCloud(o3d.core.Tensor(plant.at(0.0)))
    cloud.point.colors = o3d.core.Tensor(plant.colors[:, :3] / np.float32(255))
    renderer.scene.add_geometry("plant", cloud, material)
    renderer.setup_camera(FIELD_OF_VIEW, plant.target, plant.eye, [0, 0, 1])

    def draw(share: float) -> NDArray:
        cloud.point.positions = o3d.core.Tensor(plant.at(share))
        flag = rendering.Scene.UPDATE_POINTS_FLAG
        renderer.scene.scene.update_geometry("plant", cloud, flag)
        return np.asarray(renderer.render_to_image())

    return draw


def pygfx(plant: Plant) -> Draw:
    import pygfx as gfx
    from rendercanvas.offscreen import OffscreenRenderCanvas

    canvas = OffscreenRenderCanvas(size=plant.size, pixel_ratio=1)
    renderer, scene = gfx.renderers.WgpuRenderer(canvas), gfx.Scene()
    colors = plant.colors / np.float32(255)
    geometry = gfx.Geometry(positions=plant.at(0.0), colors=colors)
    scene.add(gfx.Points(geometry, gfx.PointsMaterial(size=POINT_SIZE, color_mode="vertex")))
    camera = gfx.PerspectiveCamera(FIELD_OF_VIEW, plant.size[0] / plant.size[1])
    camera.local.position = plant.eye
    camera.show_pos(plant.target, up=(0, 0, 1))
    canvas.request_draw(lambda: renderer.render(scene, camera))

    def draw(share: float) -> NDArray:
        geometry.positions.data[:] = plant.at(share)
        geometry.positions.update_full()
        return np.asarray(canvas.draw())

    return draw


def polyscope(plant: Plant, mode: str) -> Draw:
    import polyscope as ps

    ps.set_verbosity(0)
    ps.set_window_size(*plant.size)
    ps.init("openGL3_egl")
    ps.set_ground_plane_mode("none")
    ps.set_up_dir("z_up")
    cloud = ps.register_point_cloud("plant", plant.at(0.0))
    cloud.set_point_render_mode(mode)
    cloud.add_color_quantity("colors", plant.colors[:, :3] / 255.0, enabled=True)
    height = 2.0 * plant.distance * np.tan(np.radians(FIELD_OF_VIEW / 2))
    cloud.set_radius(float(POINT_SIZE / 2 * height / plant.size[1]), relative=False)
    ps.look_at(tuple(map(float, plant.eye)), tuple(map(float, plant.target)))

    def draw(share: float) -> NDArray:
        cloud.update_point_positions(plant.at(share))
        return ps.screenshot_to_buffer(False)

    return draw


OURS = {"play": False, "play, plain points": True}  # styles of this player: whether plain
PEERS: dict[str, Callable[[Plant], Draw]] = {
    "pyrender": pyrender,
    "vispy": vispy,
    "pyvista": pyvista,
    "open3d": open3d,
    "pygfx": pygfx,
    "polyscope spheres": lambda plant: polyscope(plant, "sphere"),
    "polyscope quads": lambda plant: polyscope(plant, "quad"),
}


def measure(name: str, count: int, size: tuple[int, int], frames: int, picture: str) -> dict:
    """Measure one library in this process.

    Returns
    -------
    dict
        Median wall and least CPU seconds of a frame, "wall" and "cpu".
    """
    plant = Plant(count, size)
    draw = player(plant, OURS[name]) if name in OURS else PEERS[name](plant)
    for share in (0.0, 0.5):
        drawn = np.asarray(draw(share))
    if picture:
        from PIL import Image

        Image.fromarray(np.ascontiguousarray(drawn[..., :3]).astype(np.uint8)).save(picture)
    walls, cpus = [], []
    for frame in range(frames):
        wall, cpu = time.perf_counter(), time.process_time()
        draw((frame + 1) / (frames + 1))
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    return {"wall": float(np.median(walls)), "cpu": min(cpus)}


def run(name: str, arguments: argparse.Namespace) -> dict | str:
    """Measure one library in a process of its own; returns the reason if that fails."""
    command = [sys.executable, "-m", "bench.peers", "--peer", name]
    command += ["--points", str(arguments.points), "--size", arguments.size]
    command += ["--frames", str(arguments.frames)]
    if arguments.pictures:
        command += ["--pictures", f"{arguments.pictures}/{name.replace(' ', '_')}.png"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    except subprocess.TimeoutExpired:
        return "skipped: more than 10 minutes"
    lines = [line for line in done.stdout.splitlines() if line.startswith('{"wall"')]
    if lines:
        return json.loads(lines[-1])
    words = done.stderr.strip().splitlines()
    missing = [line for line in words if "No module named" in line]
    return "skipped: not installed" if missing else f"skipped: {words[-1][:70] if words else '?'}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=lambda text: int(float(text)), default=1_000_000)
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--frames", type=int, default=7)
    parser.add_argument("--only", default="", help="names of libraries, separated by commas")
    parser.add_argument("--pictures", default="", help="folder for a picture of each library")
    parser.add_argument("--peer", default="", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))
    if arguments.peer:
        size, count = (width, height), arguments.points
        found = measure(arguments.peer, count, size, arguments.frames, arguments.pictures)
        print(json.dumps(found))
        return
    names = [name for name in PEERS if not arguments.only or name in arguments.only.split(",")]
    results = {name: run(name, arguments) for name in (*OURS, *names)}
    base = results["play"]
    print(f"{arguments.points:,} points, {arguments.size}\n")
    print("| | wall, ms | CPU, ms | times play's wall | times play's CPU |\n|---|---|---|---|---|")
    for name, result in results.items():
        if isinstance(result, str) or isinstance(base, str):
            print(f"| {name} | {result} | | | |")
            continue
        cells = [1e3 * result["wall"], 1e3 * result["cpu"]]
        ratios = [result[key] / base[key] for key in ("wall", "cpu")]
        print(f"| {name} | {cells[0]:.0f} | {cells[1]:.0f} | {ratios[0]:.1f} | {ratios[1]:.1f} |")


if __name__ == "__main__":
    main()
