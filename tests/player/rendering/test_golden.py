"""Pictures are the golden ones (golden.py), on Mesa's software renderer."""

from __future__ import annotations

from pathlib import Path

import moderngl
import numpy as np
import pytest

from tests.player.drawn import on_cpu
from tests.player.golden import GOLDEN, Difference, Golden, difference, kept, load, save

WAYS = [(golden, number) for golden in GOLDEN for number in range(len(golden.ways))]


@pytest.mark.parametrize(
    ("golden", "way"), WAYS, ids=[f"{golden.name}-{number}" for golden, number in WAYS]
)
def test_the_picture_is_the_golden_one(
    context: moderngl.Context, golden: Golden, way: int, tmp_path: Path
) -> None:
    if not on_cpu(context):
        pytest.skip("golden pictures are compared on Mesa's software renderer only")
    found, wanted = kept(golden.ways[way]()), load(golden.file)
    assert found.shape == wanted.shape
    off = Difference.between(found, wanted)
    if not off.within(golden.most):
        apart = np.clip(8.0 * np.abs(difference(found, wanted))[..., :3], 0, 255).astype(np.uint8)
        for name, picture in [("found", found), ("wanted", wanted), ("difference", kept(apart))]:
            save(picture, tmp_path / f"{golden.name}-{name}.png")
        pytest.fail(
            f"{golden.name}.png: {off}, at most {golden.most}; see {tmp_path}. If it is meant to "
            f"look so from now on: python -m tests.player.golden {golden.name}"
        )


def test_a_difference_that_anybody_sees_is_one() -> None:
    wanted = load(GOLDEN[0].file)
    assert Difference.between(wanted, wanted) == Difference(0.0, 0.0, 0.0)
    darker, spotted = wanted.copy(), wanted.copy()
    darker[..., :3] = (0.97 * darker[..., :3]).astype(np.uint8)
    spotted[70:78, 110:118, :3] = 255
    for changed in (darker, spotted, wanted[:, ::-1]):
        assert not Difference.between(changed, wanted).within(GOLDEN[0].most)
