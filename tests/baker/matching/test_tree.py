"""Branches of a tree are recognised when labels are numbered anew in every scan."""

import numpy as np
from scipy.spatial import cKDTree

from baker import Options, bake
from grow import plant
from grow.cli import main as grow


def test_branches_of_a_tree_are_recovered_births_included(tmp_path):
    """At least 95 % between successive scans of tree1 with its segments given, labels shuffled."""
    folder = tmp_path / "scans"
    assert grow(["tree1", str(folder), "--shuffle-labels", "-q"]) == 0
    clip = bake([folder], Options(align="none", up="z", labels="independent"))
    tree = plant("tree1")
    right, before, seen = [], {}, set()
    for k, time in enumerate(clip.times):
        cloud = tree.cloud(time)
        frame = clip.at(time + (1e-6 if k + 1 < len(clip.times) else -1e-6))
        tracks = frame.tracks[cKDTree(frame.positions).query(cloud.points)[1]]
        now = {
            int(branch): int(np.bincount(tracks[cloud.labels == branch]).argmax())
            for branch in np.unique(cloud.labels)
        }
        if k:
            right += [
                before[branch] == track if branch in before else track not in seen
                for branch, track in now.items()
            ]
        before = now
        seen |= set(now.values())
    assert np.mean(right) >= 0.95
