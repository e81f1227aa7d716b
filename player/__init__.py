"""The player: draws a clip, in a window, a picture or a film.

import gclip, player
clip = gclip.open("plant.gclip")
picture = player.render(clip, 12.5)  # (720, 1280, 4) uint8
player.film(clip, "film.mp4", turning=True)
"""

import lazy_loader

# The graphics libraries load only when a picture is wanted: `--help` stays instant.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
