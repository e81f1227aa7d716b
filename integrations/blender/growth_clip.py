"""Growth clips in Blender: File > Import > Growth clip (.gclip).

A clip becomes one object. Its mesh holds every mover of every interval, with what the clip says of
it as attributes of points: start (its position), control points, end, colours, track, times. From
these, geometry nodes make the points that are there at the scene's frame. The format is told in
docs/format.md of plant-growth-clips, of which nothing else is needed here.
"""

import json
import math
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty, StringProperty
from bpy_extras.io_utils import ImportHelper
from mathutils import Matrix

bl_info = {
    "name": "Growth clips",
    "description": "Imports the growth of a plant (.gclip) as animated points",
    "author": "plant-growth-clips",
    "version": (1, 0, 0),
    "blender": (4, 2, 0),
    "location": "File > Import > Growth clip (.gclip)",
    "category": "Import-Export",
}

DTYPES = {"U8": np.uint8, "U16": np.uint16, "U32": np.uint32, "F32": np.float32}
MAX_HEADER = 8 << 20  # bytes, and a quarter of the file
MAX_NUMBER = 1e18
LITTER_FADE = 0.15  # share of the following interval during which fallen organs fade
NEVER = 1e30  # a time after all others
METERS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001}
COLOR = "Col"  # of the points that are there; Cycles finds none that is called "color"
LAST_FRAME = 1_048_574  # that Blender can hold
VECTORS = ("position", "control1", "control2", "end")
TIMES = ("start_time", "end_time", "fade_time", "gone_time")
SEPARATE = "FunctionNodeSeparateColor"
DAMAGED = (ValueError, KeyError, TypeError, IndexError, AttributeError, ArithmeticError)


class ClipError(Exception):
    """One sentence about a file that can't be imported."""


# Reading


def read_clip(path):
    """A clip's facts (see `facts_of`) and movers (see `movers_of`). Raises ClipError."""
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise ClipError(f"{path} can't be read: {error.strerror}.") from None
    try:
        length = int.from_bytes(data[:8], "little")
        if length > min(len(data) - 8, MAX_HEADER + len(data) // 4):
            raise ValueError("a header that the file has no room for")
        header = json.loads(data[8 : 8 + length])
        document = json.loads(header["__metadata__"]["gclip"])
        version = document["version"]
        if int(version.partition(".")[0]) > 1:
            raise ClipError(f"{path} is of format {version[:20]}; this add-on reads 1.")
        content = np.frombuffer(data, np.uint8)[8 + length :]

        def take(name, *shape):
            entry = header[name]
            first, stop = entry["data_offsets"]
            return content[first:stop].view(DTYPES[entry["dtype"]]).reshape(shape)

        return facts_of(document), movers_of(document, take)
    except DAMAGED:
        raise ClipError(f"{path} is not a growth clip, or it is damaged.") from None
    except (RecursionError, MemoryError):
        raise ClipError(f"{path} is damaged, or too large for this computer.") from None


def facts_of(document):
    """What is told of the clip as a whole, as a dict; numbers about places in the clip's unit."""
    up, unit = document["up"], text(document.get("unit", ""))
    if up.removeprefix("-") not in ("x", "y", "z"):
        raise ValueError("a way up that is no axis")
    facts = {
        "up": up,
        "unit": unit,
        "meters_per_unit": METERS.get(unit, 1.0),
        "origin": np.array(document.get("origin", (0, 0, 0)), float).reshape(3).tolist(),
        "spacing": float(document.get("spacing", 0.0)),
        "scan_times": [float(scan["time"]) for scan in document["scans"]],
        "tracks": {str(i): text(track["name"]) for i, track in enumerate(document["tracks"])},
    }
    numbers = [*facts["origin"], facts["spacing"], *facts["scan_times"]]
    if not facts["scan_times"] or not np.abs(numbers).max() <= MAX_NUMBER:
        raise ValueError("no scans, or a number that is not finite")
    return facts


def text(value):
    """As Blender takes it: without halves of characters."""
    return str(value).encode("utf-8", "replace").decode()


def movers_of(document, take):
    """The movers of all intervals, one after the other.

    Parameters
    ----------
    document : dict
    take : function of a buffer's name and shape
        Gives the buffer, or raises one of the errors in DAMAGED.

    Returns
    -------
    dict of str to array
        What each mover has. Four vectors about the clip's origin, the control points only as far as
        the highest degree in the clip needs them. Colours in sRGB at both ends. Its track, whether
        it falls, and four times, counted from the first scan: it is there from the first to the
        last, moves up to the second, and fades away from the third on.
    """
    intervals = document["intervals"]
    degrees = {interval["degree"] for interval in intervals}
    if not degrees <= {1, 2, 3}:
        raise ValueError("paths of a degree that the format does not know")
    degree = max(degrees)
    palette = np.array([[*track["color"], 255] for track in document["tracks"]], np.uint8)
    lengths = [interval["end"] - interval["start"] for interval in intervals]
    if any(before["end"] != after["start"] for before, after in pairwise(intervals)):
        raise ValueError("intervals that do not follow one another")
    parts = []
    for index, interval in enumerate(intervals):
        prefix, count = f"{index:04d}", sum(group["count"] for group in interval["groups"])
        curve = curve_of(interval, prefix, count, take)
        while len(curve) <= degree:
            curve = raised(curve)
        tracks = take(f"{prefix}/track", count)
        ends = [f"{prefix}/start_color", f"{prefix}/end_color"]
        try:
            colors = [take(name, count, 4) for name in ends]
        except KeyError:
            colors = [start_palette(document["tracks"], interval, palette)[tracks], palette[tracks]]
        begin = interval["start"] - intervals[0]["start"]
        following = lengths[index + 1] if index + 1 < len(intervals) else NEVER
        parts.append({
            **dict(zip([*VECTORS[:degree], "end"], curve, strict=True)),
            **dict(zip(["start_color", "end_color"], colors, strict=True)),
            "track": tracks.astype(np.int32),
            "falls": each_of(interval, [g["motion"] == "fall" for g in interval["groups"]]),
            **times_of(interval, begin, lengths[index], following),
        })  # fmt: skip
        if tracks.max() >= len(palette) or not np.abs(curve).max() <= MAX_NUMBER:
            raise ValueError("a track without a name, or a position that is not finite")
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def start_palette(tracks, interval, palette):
    """The tracks' colours as an interval begins: what is born in it has its parent's."""
    begin, end = interval["start"], interval["end"]
    newborn = [begin < track.get("born", 0.0) <= end for track in tracks]
    found = palette.copy()
    for index in np.flatnonzero(newborn):
        source, passed = tracks[index].get("parent"), {index}
        while source is not None and newborn[source] and source not in passed:
            passed.add(source)
            source = tracks[source].get("parent")
        if source is not None and not newborn[source]:
            found[index] = palette[source]
    return found


def curve_of(interval, prefix, count, take):
    """(degree + 1, count, 3) the Bézier points, from start to end."""
    names = [*("start", "control1", "control2")[: interval["degree"]], "end"]
    points = np.array([take(f"{prefix}/{name}", count, 3) for name in names], np.float64)
    box = interval.get("box")
    if box is None:
        return points
    low, high = np.array(box["low"], float), np.array(box["high"], float)
    return low + (high - low) / 65535.0 * points


def raised(curve):
    """The same Bézier curves, with one more control point."""
    share = np.arange(1, len(curve)).reshape(-1, 1, 1) / len(curve)
    return np.concatenate([curve[:1], share * curve[:-1] + (1 - share) * curve[1:], curve[-1:]])


def times_of(interval, begin, length, following):
    """The four times of each mover, by its group's motion (docs/format.md, "Where a mover is")."""
    if not 1e-9 <= length <= MAX_NUMBER:
        raise ValueError("an interval without duration")
    end = begin + length
    stays = NEVER if following == NEVER else end
    at_once = np.nextafter(np.float32(begin), np.float32(NEVER))
    fade_and_gone = {
        "move": (stays, stays),
        "fall": (end, end + LITTER_FADE * following),
        "fade": (begin, end),
        "remove": (at_once, at_once),
    }
    rows = [(begin, end, *fade_and_gone[group["motion"]]) for group in interval["groups"]]
    columns = zip(TIMES, zip(*rows, strict=True), strict=True)
    return {name: each_of(interval, np.array(column, np.float32)) for name, column in columns}


def each_of(interval, values):
    """One value a group, as one a mover."""
    return np.repeat(values, [group["count"] for group in interval["groups"]])


# Building


def build(context, name, facts, movers, frames_a_day, meters):
    """The clip as an object, with its animation, in the scene. Returns the object."""
    thing = bpy.data.objects.new(name, mesh_of(name, movers))
    scale = facts["meters_per_unit"] if meters else 1.0
    thing.matrix_world = Matrix.Scale(scale, 4) @ upright(facts["up"]).to_4x4()
    for key, value in facts.items():
        thing[key] = value
    context.collection.objects.link(thing)

    scene = context.scene
    size = np.ptp(movers["end"], axis=0).max()
    radius = facts["spacing"] or float(size) / 500.0
    degree = sum(name in movers for name in VECTORS) - 1
    modifier = thing.modifiers.new("Growth clip", "NODES")
    modifier.node_group = nodes(degree, scene.frame_start, frames_a_day, radius, material())
    length = facts["scan_times"][-1] - facts["scan_times"][0]
    scene.frame_end = min(scene.frame_start + math.ceil(length * frames_a_day), LAST_FRAME)
    return thing


def upright(up):
    """The rotation (3 x 3) that turns the plant's growing direction to Blender's z."""
    index, sign = "xyz".index(up[-1]), -1.0 if up.startswith("-") else 1.0
    unit = np.eye(3)
    return Matrix([unit[(index + 1) % 3], sign * unit[(index + 2) % 3], sign * unit[index]])


def mesh_of(name, movers):
    """A mesh of points without faces; all but their positions are attributes."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(movers["position"]))
    mesh.vertices.foreach_set("co", movers["position"].astype(np.float32).ravel())
    for key, values in movers.items():
        if key in VECTORS[1:]:
            kind, field, values = "FLOAT_VECTOR", "vector", values.astype(np.float32)
        elif key.endswith("_color"):  # Blender calculates with these in linear light
            kind, field, values = "BYTE_COLOR", "color_srgb", values.astype(np.float32) / 255
        elif key in TIMES:
            kind, field = "FLOAT", "value"
        elif key in ("track", "falls"):
            kind, field = {"track": "INT", "falls": "BOOLEAN"}[key], "value"
        else:
            continue
        mesh.attributes.new(key, kind, "POINT").data.foreach_set(field, values.ravel())
    mesh.update()
    return mesh


def material():
    """A matt surface of the points' own colours, as transparent as they are."""
    made = bpy.data.materials.new("Growth clip")
    if made.node_tree is None:  # before Blender 5
        made.use_nodes = True
    tree = made.node_tree
    surface = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    surface.inputs["Roughness"].default_value = 0.8
    color = tree.nodes.new("ShaderNodeAttribute")
    color.attribute_name = COLOR
    tree.links.new(color.outputs["Color"], surface.inputs["Base Color"])
    tree.links.new(color.outputs["Alpha"], surface.inputs["Alpha"])
    return made


class Graph:
    """A node group that is written as formulas: what a method returns is a node's output."""

    def __init__(self, tree):
        self.tree = tree

    def add(self, kind, inputs=(), output=0, **settings):
        """A node of a kind, its settings made, its inputs linked or set; one of its outputs."""
        column, row = divmod(len(self.tree.nodes), 6)
        node = self.tree.nodes.new(kind)
        node.location = (200 * column, -180 * row)
        for name, value in settings.items():
            setattr(node, name, value)
        enabled = [socket for socket in node.inputs if socket.enabled]
        for socket, value in zip(enabled, inputs, strict=False):
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            elif value is not None:
                socket.default_value = value
        return [socket for socket in node.outputs if socket.enabled][output]

    def named(self, name, kind="FLOAT"):
        return self.add("GeometryNodeInputNamedAttribute", [name], data_type=kind)

    def math(self, operation, *inputs, clamped=False):
        return self.add("ShaderNodeMath", inputs, operation=operation, use_clamp=clamped)

    def mix(self, kind, share, start, end):
        return self.add("ShaderNodeMix", [share, start, end], data_type=kind)


def nodes(degree, first_frame, frames_a_day, radius, surface):
    """The node group that makes of all movers the points that are there at the scene's frame."""
    tree = bpy.data.node_groups.new("Growth clip", "GeometryNodeTree")
    tree.is_modifier = True
    interface = tree.interface
    interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    for name, kind, value in (
        ("First Frame", "NodeSocketFloat", float(first_frame)),
        ("Frames a Day", "NodeSocketFloat", frames_a_day),
        ("Radius", "NodeSocketFloat", radius),
        ("Material", "NodeSocketMaterial", surface),
    ):
        socket = interface.new_socket(name, in_out="INPUT", socket_type=kind)
        socket.default_value = value

    graph = Graph(tree)
    given = tree.nodes.new("NodeGroupInput").outputs
    frame = graph.add("GeometryNodeInputSceneTime", output=1)
    passed = graph.math("SUBTRACT", frame, given["First Frame"])
    day = graph.math("MAXIMUM", graph.math("DIVIDE", passed, given["Frames a Day"]), 0.0)
    start, end, fade, gone = (graph.named(name) for name in TIMES)

    begun = graph.math("SUBTRACT", 1.0, graph.math("LESS_THAN", day, start))
    there = graph.math("MULTIPLY", begun, graph.math("LESS_THAN", day, gone))
    absent = graph.math("LESS_THAN", there, 0.5)
    points = graph.add("GeometryNodeDeleteGeometry", [given["Geometry"], absent])

    def share(first, last):
        """How much of a time has passed, from 0 to 1."""
        length = graph.math("SUBTRACT", last, first)
        return graph.math("DIVIDE", graph.math("SUBTRACT", day, first), length, clamped=True)

    passed = share(start, end)
    fallen = graph.math("MULTIPLY", passed, passed)  # by gravity
    falls = graph.named("falls", "BOOLEAN")
    along = graph.add("GeometryNodeSwitch", [falls, passed, fallen], input_type="FLOAT")
    curve = [graph.named(name, "FLOAT_VECTOR") for name in (*VECTORS[:degree], "end")]
    while len(curve) > 1:  # de Casteljau
        curve = [graph.mix("VECTOR", along, *ends) for ends in pairwise(curve)]
    points = graph.add("GeometryNodeSetPosition", [points, None, curve[0]])

    ends = [graph.named(name, "FLOAT_COLOR") for name in ("start_color", "end_color")]
    parts = [  # of which a mix of colors would take the first one's alpha
        graph.mix("FLOAT", passed, *(graph.add(SEPARATE, [end], channel) for end in ends))
        for channel in range(4)
    ]
    shown = graph.math("SUBTRACT", 1.0, share(fade, gone))
    parts[3] = graph.math("MULTIPLY", parts[3], shown)
    color = graph.add("FunctionNodeCombineColor", parts)
    points = graph.add(
        "GeometryNodeStoreNamedAttribute", [points, None, COLOR, color], data_type="FLOAT_COLOR"
    )
    points = graph.add("GeometryNodeMeshToPoints", [points, None, None, given["Radius"]])
    points = graph.add("GeometryNodeSetMaterial", [points, None, given["Material"]])
    tree.links.new(points, tree.nodes.new("NodeGroupOutput").inputs[0])
    return tree


# The menu


class ImportGrowthClip(bpy.types.Operator, ImportHelper):
    """Import the growth of a plant as animated points"""

    bl_idname = "import_scene.gclip"
    bl_label = "Import growth clip"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    filename_ext = ".gclip"
    filter_glob: StringProperty(default="*.gclip", options={"HIDDEN"})
    frames_a_day: FloatProperty(
        name="Frames a day", default=24.0, min=0.001, description="How fast the plant grows"
    )
    meters: BoolProperty(
        name="Scale to metres", default=True, description="Where the clip tells its unit"
    )

    def execute(self, context):
        try:
            facts, movers = read_clip(self.filepath)
        except ClipError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        name = Path(self.filepath).stem
        thing = build(context, name, facts, movers, self.frames_a_day, self.meters)
        for other in context.selected_objects:
            other.select_set(False)
        thing.select_set(True)
        context.view_layer.objects.active = thing
        return {"FINISHED"}


def menu_entry(menu, context):
    menu.layout.operator(ImportGrowthClip.bl_idname, text="Growth clip (.gclip)")


def register():
    bpy.utils.register_class(ImportGrowthClip)
    bpy.types.TOPBAR_MT_file_import.append(menu_entry)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(menu_entry)
    bpy.utils.unregister_class(ImportGrowthClip)
