"""Series of colour and depth images from a camera that stays where it is (the Komatsuna data).

A folder with a file `camera.toml` or `camera.json` is such a series: that file says how the camera
sees (`baker.rgbd.camera`), the images are found and timed by their names (`baker.rgbd.images`),
depth is repaired at the borders of organs (`baker.rgbd.repair`) and turned into coloured, labelled
point clouds (`baker.rgbd.series`). `baker.scans.read_series` reads it like any other series.
"""
