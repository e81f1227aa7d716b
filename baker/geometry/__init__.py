"""Neighbours, graphs, surfaces, sampling and rotations of point clouds, mostly with SciPy."""
