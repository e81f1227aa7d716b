"""The motion of movers between scans: spines, deformation, control points, attachment, density."""
