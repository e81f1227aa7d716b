"""Positions in the files of the scans, found from a clip's provenance whatever that holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from gclip.places import baked_corrections, rename_organs, to_file_coordinates

POINT = np.array([1.0, 2.0, 3.0])
FORGED = [10**400, "x", float("nan"), float("inf"), [], {}]


def placed(clip, *, transform: Any = None, scale: Any = 2.0, origin: Any = (1.0, 1.0, 1.0)):
    """The clip with where its scans were placed, as a bake writes it."""
    count = len(clip.scans)
    given = {
        "inputs": [{"name": scan.name} for scan in clip.scans],
        "transforms": [np.eye(4).tolist() if transform is None else transform] * count,
        "origins": [origin] * count,
        "options": {"scale": scale},
    }
    return replace(clip, provenance=given)


def test_a_point_is_where_the_file_has_it(make_clip) -> None:
    clip = placed(make_clip())
    # local = scale * file - origin
    assert to_file_coordinates(clip, clip.scans[0].name, POINT).tolist() == [1.0, 1.5, 2.0]


@pytest.mark.parametrize("forged", FORGED, ids=lambda value: str(value)[:8])
@pytest.mark.parametrize("field", ["transform", "number", "scale", "origin", "options"])
def test_provenance_may_hold_anything(make_clip, field: str, forged: Any) -> None:
    clip = make_clip()
    name = clip.scans[0].name
    usual = to_file_coordinates(replace(clip, provenance={}), name, POINT)
    if field == "options":
        clip = replace(placed(clip), provenance={"options": forged})
    elif field == "number":
        clip = placed(clip, transform=[[forged, 0, 0, 0], *np.eye(4)[1:].tolist()])
    else:
        clip = placed(clip, **{field: forged})
    assert np.allclose(to_file_coordinates(clip, name, POINT), usual)
    assert baked_corrections(clip) == ()
    assert rename_organs(clip, ()).track_table == clip.track_table
