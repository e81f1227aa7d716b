"""The player: shows clips in a window, and exports them to pictures, films and other formats.

import gclip, player
clip = gclip.open("plant.gclip")
picture = player.render(clip, 12.5)  # (720, 1280, 4) uint8
player.film(clip, "film.mp4", turning=True)
"""

import lazy_loader

# Submodules are imported on first use to keep `play --help` fast.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
