"""Run by Blender's Python: imports clips and files that are none, and says what came of it.

python in_blender.py TASKS.json: {"add_on": path, "clips": {path: days}, "bad": [paths], "picture":
[clip, day, path]}. Beside each clip a file .npz is written with what Blender evaluates at each day;
for the bad files, TASKS.json.said holds what the user is told.
"""

import importlib.util
import json
import math
import sys
from pathlib import Path

import bpy
import numpy as np

FRAMES_A_DAY = 40.0


def load(path):
    spec = importlib.util.spec_from_file_location("growth_clip", path)
    add_on = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(add_on)
    return add_on


def show(day, first_day):
    frame = 1.0 + (day - first_day) * FRAMES_A_DAY
    whole = math.floor(frame)
    bpy.context.scene.frame_set(whole, subframe=frame - whole)


def imported(path):
    result = bpy.ops.import_scene.gclip(filepath=path, frames_a_day=FRAMES_A_DAY)
    assert result == {"FINISHED"}
    return bpy.context.object


def points_now(plant):
    """What Blender evaluates at the scene's frame: each attribute as an array."""
    geometry = plant.evaluated_get(bpy.context.evaluated_depsgraph_get()).evaluated_geometry()
    found = {}
    for name, field, width, dtype in (
        ("position", "vector", 3, np.float32),
        ("Col", "color", 4, np.float32),
        ("track", "value", 1, np.int32),
        ("radius", "value", 1, np.float32),
    ):
        values = np.zeros(len(geometry.pointcloud.points) * width, dtype)
        geometry.pointcloud.attributes[name].data.foreach_get(field, values)
        found[name] = values.reshape(-1, width) if width > 1 else values
    return found


def evaluate(path, days):
    plant = imported(path)
    found = {
        "matrix": np.array(plant.matrix_world),
        "origin": np.array(plant["origin"]),
        "unit": np.array([plant["unit"]]),
        "tracks": np.array(list(plant["tracks"].values())),
        "frames": np.array([bpy.context.scene.frame_start, bpy.context.scene.frame_end]),
    }
    for index, day in enumerate(days):
        show(day, plant["scan_times"][0])
        found |= {f"{index}/{name}": values for name, values in points_now(plant).items()}
    np.savez(path + ".npz", **found)
    bpy.data.objects.remove(plant)


def told(path):
    try:
        bpy.ops.import_scene.gclip(filepath=path)
    except RuntimeError as error:
        return str(error)
    return ""


def render(clip, day, path):
    """The plant in front of a white world, by Cycles on the processor."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    plant = imported(clip)
    show(day, plant["scan_times"][0])
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 8, False
    scene.render.resolution_x, scene.render.resolution_y = 360, 480
    scene.view_settings.view_transform = "Standard"
    world = bpy.data.worlds.new("white")
    if world.node_tree is None:  # before Blender 5
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    scene.world = world
    places = points_now(plant)["position"] @ np.array(plant.matrix_world)[:3, :3].T
    low, high = places.min(axis=0), places.max(axis=0)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 1.5 * float((high - low).max())
    middle = (low + high) / 2
    camera.location = (middle[0], low[1] - 2 * float((high - low).max()), middle[2])
    camera.rotation_euler = (math.pi / 2, 0, 0)
    camera.data.clip_start = 1e-4
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def main(path):
    tasks = json.loads(Path(path).read_text())
    add_on = load(tasks["add_on"])
    add_on.register()
    for clip, days in tasks["clips"].items():
        evaluate(clip, days)
    said = {bad: told(bad) for bad in tasks["bad"]}
    Path(path + ".said").write_text(json.dumps(said))
    render(*tasks["picture"])
    add_on.unregister()


main(sys.argv[-1])
