"""Many plants: one clip for each folder of scans, by processes here or by workers of a cluster.

`plants` finds the plants, `work` bakes one and says how it went, `local` and `cluster` share them
out, `run` is where these meet. Nothing here is needed to bake one plant.
"""
