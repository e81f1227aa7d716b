"""Optimal transport between matched segments, and correspondences of points (section 3.4)."""
