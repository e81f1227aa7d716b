"""What movers do between two scans: spines, deformation, control points, attachment, density."""
