"""Series of colour and depth images from a camera that stays where it is (the Komatsuna data).

A folder with a file `camera.toml` or `camera.json` is such a series: that file says how the camera
sees (`camera`), the images are found and timed by their names (`images`), depth is repaired at the
borders of organs (`depth_repair`) and turned into coloured, labelled point clouds (`series`).
`baker.scans.read_series` reads it like any other series.
"""
