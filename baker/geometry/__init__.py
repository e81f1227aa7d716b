"""Neighbours, graphs, sampling and rigid motions of point clouds, thin on scipy and Open3D."""
