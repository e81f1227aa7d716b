"""The player: a clip becomes light, in a window, a picture or a film.

from player import render
picture = render(gclip.open("plant.gclip"), day=12.5, size=(1280, 720))   # (720, 1280, 4) uint8
"""

import lazy_loader

# The graphics libraries load when a picture is wanted: `play --help` stays instant.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
