"""The container: what is written comes back; what is damaged is refused in one sentence."""

import json
import os
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from safetensors import safe_open
from safetensors.numpy import save_file

import gclip
from baker.interpolation.packing import Movers, pack_interval
from gclip import Motion


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("colors", [False, True])
@pytest.mark.parametrize("precision", ["auto", "float32"])
def test_what_is_written_comes_back(make_clip, tmp_path, degree, colors, precision):
    clip = make_clip(degree=degree, colors=colors, precision=precision)
    clip.save(tmp_path / "c.gclip")
    again = gclip.open(tmp_path / "c.gclip")
    assert again.scans == clip.scans
    assert again.track_table == clip.track_table
    assert again.provenance == clip.provenance
    for ours, theirs in zip(clip.intervals, again.intervals, strict=True):
        assert theirs.box == ours.box
        assert theirs.groups == ours.groups
        assert len(theirs.curve) == degree + 1
        for a, b in zip(ours.curve, theirs.curve, strict=True):
            assert np.array_equal(a, b)
    for day in (0.0, 1.1, 2.0, 4.4, 5.0):
        assert np.array_equal(clip.at(day).positions, again.at(day).positions)
        assert np.array_equal(clip.at(day).colors, again.at(day).colors)


def test_scans_left_out_come_back(make_clip, tmp_path):
    points = np.random.default_rng(3).random((20, 3)).astype(np.float32)
    left_out = gclip.ScanMark("x.ply", 1.5, "day 1.5", len(points), points)
    replace(make_clip(), held_out=(left_out,)).save(tmp_path / "c.gclip")
    (again,) = gclip.open(tmp_path / "c.gclip").held_out
    assert (again.name, again.time, again.date) == ("x.ply", 1.5, "day 1.5")
    assert np.array_equal(again.positions, points)


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("time", 9.0, "outside the series"),
        ("points", 21, "the document needs float32"),
        ("name", 7, r"at held_out\[0\].name: expected `str`, got `int`"),
    ],
)
def test_scans_left_out_are_checked(make_clip, tmp_path, field, value, words):
    points = np.zeros((20, 3), np.float32)
    left_out = gclip.ScanMark("x.ply", 1.5, "day 1.5", len(points), points)
    replace(make_clip(), held_out=(left_out,)).save(tmp_path / "c.gclip")
    rewrite(tmp_path / "c.gclip", lie(field, value, "held_out", 0))
    with pytest.raises(gclip.ClipError, match=words):
        gclip.open(tmp_path / "c.gclip")


def test_bytes_a_mover(make_clip, tmp_path):
    for degree, colors, expected in ((1, False, 14), (2, False, 20), (2, True, 28), (3, False, 26)):
        clip = make_clip(degree=degree, colors=colors)
        clip.save(tmp_path / "c.gclip")
        with safe_open(tmp_path / "c.gclip", "numpy") as container:
            size = sum(container.get_tensor(name).nbytes for name in container.keys())  # noqa: SIM118
        assert size == expected * sum(len(interval) for interval in clip.intervals)


def test_same_clip_same_bytes(make_clip, tmp_path):
    make_clip().save(tmp_path / "a.gclip")
    make_clip().save(tmp_path / "b.gclip")
    assert (tmp_path / "a.gclip").read_bytes() == (tmp_path / "b.gclip").read_bytes()


def test_saving_leaves_nothing_beside_and_respects_the_umask(make_clip, tmp_path):
    before = os.umask(0o027)
    try:
        make_clip().save(tmp_path / "c.gclip")
    finally:
        os.umask(before)
    assert [p.name for p in tmp_path.iterdir()] == ["c.gclip"]
    assert (tmp_path / "c.gclip").stat().st_mode & 0o777 == 0o640


def test_a_failed_save_keeps_the_old_clip(make_clip, tmp_path, monkeypatch):
    clip = make_clip()
    clip.save(tmp_path / "c.gclip")
    before = (tmp_path / "c.gclip").read_bytes()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(gclip.UserError, match="No space left"):
        make_clip(degree=2).save(tmp_path / "c.gclip")
    assert (tmp_path / "c.gclip").read_bytes() == before
    assert len(list(tmp_path.iterdir())) == 1


def test_replacing_the_file_leaves_an_open_clip_whole(make_clip, tmp_path):
    path = tmp_path / "c.gclip"
    make_clip().save(path)
    clip = gclip.open(path)
    before = clip.at(1.0).positions
    make_clip(degree=3).save(path)
    assert np.array_equal(clip.at(1.0).positions, before)
    path.unlink()
    assert np.array_equal(clip.at(1.0).positions, before)


def test_missing_folder_is_a_sentence(make_clip, tmp_path):
    with pytest.raises(gclip.UserError, match="No such file or directory"):
        make_clip().save(tmp_path / "nowhere" / "c.gclip")


def test_not_a_clip(tmp_path):
    target = tmp_path / "x.gclip"
    with pytest.raises(gclip.ClipError, match="no such file"):
        gclip.open(target)
    with pytest.raises(gclip.ClipError, match="not even a file"):
        gclip.open(tmp_path)
    for content in (b"", b"PK\x03\x04" + b"x" * 100, b"\xff" * 64):
        target.write_bytes(content)
        with pytest.raises(gclip.ClipError, match="not a growth clip"):
            gclip.open(target)
    save_file({"a": np.zeros(3)}, target)
    with pytest.raises(gclip.ClipError, match='without the key "gclip"'):
        gclip.open(target)


def rewrite(path, change) -> None:
    """Write a clip's container again with its document and buffers changed by hand."""
    with safe_open(path, "numpy") as container:
        document = json.loads(container.metadata()["gclip"])
        buffers = {name: container.get_tensor(name) for name in container.offset_keys()}
    text = change(document, buffers)
    save_file(buffers, path, {"gclip": text or json.dumps(document)})


def lie(field, value, *path):
    def change(document, buffers):
        place = document
        for step in path:
            place = place[step]
        place[field] = value

    return change


def drop(name):
    return lambda document, buffers: buffers.pop(name) is None or None


def put(name, value):
    def change(document, buffers):
        buffers[name] = value

    return change


LIES = {
    "newer version": (lie("version", "2.0"), "newer version"),
    "version is no number": (lie("version", "x"), "version"),
    "up": (lie("up", "w"), "up"),
    "one scan": (lie("scans", []), "length >= 2"),
    "times descend": (lie("time", 9.0, "scans", 0), "ascend"),
    "time is infinite": (lie("time", 1e999, "scans", 0), "not valid JSON"),
    "no tracks": (lie("tracks", []), "at tracks: .* length >= 1"),
    "color": (lie("color", [0, 0, 256], "tracks", 0), "<= 255"),
    "parent": (lie("parent", 7, "tracks", 1), "parent"),
    "degree": (lie("degree", 4, "intervals", 0), "degree"),
    "a buffer too few": (lie("degree", 2, "intervals", 0), "missing"),
    "interval backwards": (lie("end", -1.0, "intervals", 0), "it must end"),
    "intervals with a gap": (lie("start", 2.5, "intervals", 1), "gap"),
    "box upside down": (lie("low", [999, 0, 0], "intervals", 0, "box"), "low corner"),
    "box not finite": (lie("low", [float("nan"), 0, 0], "intervals", 0, "box"), "not valid JSON"),
    "box missing": (lie("box", None, "intervals", 0), "float32"),
    "groups overlap": (lie("first", 3, "intervals", 1, "groups", 1), "do not cover"),
    "huge count": (lie("count", 2**40, "intervals", 0, "groups", 0), "needs"),
    "motion": (lie("motion", "dance", "intervals", 0, "groups", 0), "motion"),
    "not JSON": (lambda d, b: "{", "JSON"),
    "deep JSON": (lambda d, b: '{"version":' + "[" * 100_000, "expected `str`, got `array`"),
    "JSON list": (lambda d, b: "[]", "expected `object`, got `array`"),
    "missing buffer": (drop("0001/track"), "missing"),
    "buffer nobody names": (put("0009/start", np.zeros((3, 3), np.uint16)), "nothing names"),
    "foreign dtype": (put("0000/track", np.zeros(300, np.float64)), "type F64"),
    "shape": (put("0000/track", np.zeros((300, 2), np.uint16)), "needs"),
    "track out of range": (put("0000/track", np.full(300, 2, np.uint16)), "name track 2"),
    "one color only": (put("0000/end_color", np.zeros((300, 4), np.uint8)), "missing"),
}


@pytest.mark.parametrize("name", LIES)
def test_lies_are_refused_in_one_sentence(make_clip, tmp_path, name):
    change, expected = LIES[name]
    path = tmp_path / "c.gclip"
    make_clip().save(path)
    rewrite(path, change)
    with pytest.raises(gclip.ClipError, match=expected) as refusal:
        gclip.open(path)
    assert str(refusal.value).startswith(str(path))
    assert "\n" not in str(refusal.value)


def test_nan_positions_are_refused(make_clip, tmp_path):
    path, clip = tmp_path / "c.gclip", make_clip(precision="float32")
    clip.save(path)
    positions = clip.intervals[0].curve[0]
    positions[5, 1] = np.nan
    rewrite(path, lambda document, buffers: buffers.update({"0000/start": positions}))
    with pytest.raises(gclip.ClipError, match="not finite"):
        gclip.open(path)
    with pytest.raises(gclip.ClipError, match=r"can't be written: in interval 0, .* not finite"):
        clip.save(path)


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_damage_is_refused_or_harmless(make_clip, tmp_path, data):
    path = tmp_path / "c.gclip"
    clip = make_clip(lost=Motion.FADE)
    replace(clip, provenance={}).save(path)
    content = bytearray(path.read_bytes())
    if data.draw(st.booleans()):
        del content[data.draw(st.integers(0, len(content) - 1)) :]
    for _ in range(data.draw(st.integers(0, 3))):
        if content:
            content[data.draw(st.integers(0, min(len(content), 4000) - 1))] ^= 1 << data.draw(
                st.integers(0, 7)
            )
    path.write_bytes(content)
    try:
        damaged = gclip.open(path)
        positions = damaged.at(damaged.times[0]).positions
    except gclip.ClipError as refusal:
        sentence, positions = str(refusal), np.zeros(1)
    else:
        sentence = ""
    assert "\n" not in sentence
    assert np.isfinite(positions).all()


@pytest.mark.parametrize("precision", ["auto", "float32"])
def test_flat_clips_and_those_of_one_place_are_clips(make_clip, tmp_path, precision):
    """A box may be as low as it is high."""
    for flat in ([1, 1, 0], [0, 0, 0]):
        points = np.random.default_rng(0).random((50, 3)) * flat + 2.0
        movers = Movers(Motion.MOVE, (points, points[::-1] + flat), np.zeros(50, int))
        interval = pack_interval(0.0, 2.0, [movers], spacing=5.0, precision=precision)
        clip = replace(make_clip(), scans=make_clip().scans[:2], intervals=(interval,))
        clip.save(tmp_path / "flat.gclip")
        opened = gclip.open(tmp_path / "flat.gclip")
        assert np.ptp(opened.at(1.0).positions[:, 2]) == 0
        assert (opened.intervals[0].box is None) == (precision == "float32")
