"""One way to write a point cloud in every format, to read it back."""

import gzip
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray


@dataclass(frozen=True)
class Sample:
    """What a file should hold: points (N, 3) float, labels (N,) ints, colours (N, 3) uint8."""

    points: NDArray
    labels: NDArray | None = None
    colors: NDArray | None = None

    def columns(self) -> dict[str, NDArray]:
        columns = {axis: self.points[:, i] for i, axis in enumerate("xyz")}
        if self.colors is not None:
            columns |= {name: self.colors[:, i] for i, name in enumerate(("red", "green", "blue"))}
        if self.labels is not None:
            columns["label"] = self.labels
        return columns


def write_table(path: Path, sample: Sample, delimiter: str = " ", header: str = "none") -> None:
    columns = sample.columns()
    names = delimiter.join(columns)
    first = {"none": "", "plain": f"{names}\n", "#": f"# {names}\n", "//": f"//{names}\n"}[header]
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    path.write_text(first + "".join(delimiter.join(map(repr, row)) + "\n" for row in rows))


def write_ply(path: Path, sample: Sample, text: bool = False, byte_order: str = "<") -> None:
    from plyfile import PlyData, PlyElement

    columns = sample.columns()
    kinds = {name: "i4" if name == "label" else values.dtype for name, values in columns.items()}
    vertices = np.zeros(len(sample.points), dtype=list(kinds.items()))
    for name, values in columns.items():
        vertices[name] = values
    faces = np.array([([0, 0, 0],)], dtype=[("vertex_indices", "i4", (3,))])
    elements = [PlyElement.describe(vertices, "vertex"), PlyElement.describe(faces, "face")]
    PlyData(elements, text=text, byte_order=byte_order).write(str(path))


def write_pcd(path: Path, sample: Sample, **encoding: bool) -> None:
    import open3d as o3d

    cloud = o3d.t.geometry.PointCloud(np.ascontiguousarray(sample.points))
    if sample.colors is not None:
        cloud.point["colors"] = o3d.core.Tensor(np.ascontiguousarray(sample.colors))
    if sample.labels is not None:
        cloud.point["label"] = o3d.core.Tensor(sample.labels[:, None].astype(np.int32))
    assert o3d.t.io.write_point_cloud(str(path), cloud, **encoding)


def write_las(path: Path, sample: Sample) -> None:
    import laspy

    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = np.full(3, 1e-4), np.floor(sample.points.min(axis=0))
    file = laspy.LasData(header)
    file.x, file.y, file.z = sample.points.T
    if sample.labels is not None:
        file.add_extra_dim(laspy.ExtraBytesParams("label", "int32"))
        file.label = sample.labels
    if sample.colors is not None:
        for name, channel in zip(("red", "green", "blue"), sample.colors.T, strict=True):
            file[name] = channel.astype(np.uint16) * 256
    file.write(path)


def write_npz(path: Path, sample: Sample) -> None:
    arrays = {"points": sample.points, "colors": sample.colors, "labels": sample.labels}
    np.savez(path, **{name: values for name, values in arrays.items() if values is not None})


def write_npy(path: Path, sample: Sample) -> None:
    columns = sample.columns()
    np.save(path, np.rec.fromarrays(list(columns.values()), names=list(columns)))


def write_e57(path: Path, sample: Sample) -> None:
    import pye57

    names = {"x": "cartesianX", "y": "cartesianY", "z": "cartesianZ"}
    names |= {"red": "colorRed", "green": "colorGreen", "blue": "colorBlue"}
    columns = {names[name]: values for name, values in sample.columns().items() if name in names}
    file = pye57.E57(str(path), mode="w")
    file.write_scan_raw({k: np.ascontiguousarray(v) for k, v in columns.items()})
    file.close()


def gzipped(write: "Writer") -> "Writer":
    """Write a file as `write` does, then gzip it."""

    def write_gzipped(path: Path, sample: Sample) -> None:
        write(path, sample)
        path.write_bytes(gzip.compress(path.read_bytes(), mtime=0))

    return write_gzipped


Writer = Callable[[Path, Sample], None]

FORMATS: dict[str, tuple[str, Writer]] = {
    "ply ascii": (".ply", lambda path, sample: write_ply(path, sample, text=True)),
    "ply little-endian": (".ply", write_ply),
    "ply big-endian": (".ply", lambda path, sample: write_ply(path, sample, byte_order=">")),
    "pcd ascii": (".pcd", lambda path, sample: write_pcd(path, sample, write_ascii=True)),
    "pcd binary": (".pcd", write_pcd),
    "pcd compressed": (".pcd", lambda path, sample: write_pcd(path, sample, compressed=True)),
    "xyz": (".xyz", write_table),
    "txt, tabs, //": (".txt", lambda path, sample: write_table(path, sample, "\t", "//")),
    "csv, header": (".csv", lambda path, sample: write_table(path, sample, ",", "plain")),
    "asc, semicolons, #": (".asc", lambda path, sample: write_table(path, sample, ";", "#")),
    "pts": (".pts", write_table),
    "las": (".las", write_las),
    "laz": (".laz", write_las),
    "npz": (".npz", write_npz),
    "npy": (".npy", write_npy),
    "xyz, gzipped": (".xyz.gz", gzipped(write_table)),
    "ply, gzipped": (".ply.gz", gzipped(write_ply)),
}


@pytest.fixture(params=FORMATS)
def any_format(request: pytest.FixtureRequest) -> tuple[str, Writer]:
    """The suffix and the writer of every format and dialect in turn."""
    return FORMATS[request.param]


@pytest.fixture
def make_sample() -> Callable[..., Sample]:
    def make(
        count: int = 50,
        seed: int = 0,
        offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
        dtype: type = np.float64,
        labels: bool = True,
        colors: bool = True,
    ) -> Sample:
        random = np.random.default_rng(seed)
        # Multiples of LAS' scale in the tests, so that every format can hold them exactly.
        steps = random.integers(-(10**6), 10**6, (count, 3))
        return Sample(
            (steps * 1e-4 + offset).astype(dtype),
            np.where(steps[:, 0] > 0, 9, -3) if labels else None,
            random.integers(0, 256, (count, 3)).astype(np.uint8) if colors else None,
        )

    return make


@pytest.fixture
def table() -> Callable[..., None]:
    return write_table


@pytest.fixture
def make_folder(tmp_path: Path) -> Callable[..., Path]:
    """Write files of text (or bytes) into a folder: make_folder({"day1.txt": "0 0 0"})."""

    def make(files: dict[str, str | bytes], name: str = "scans") -> Path:
        folder = tmp_path / name
        for file, content in files.items():
            path = folder / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content.encode() if isinstance(content, str) else content)
        return folder

    return make
