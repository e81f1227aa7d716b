"""What is looked at and how, without OpenGL and without a window: cameras, colors, playback."""

import lazy_loader

# numpy loads when a camera or a colour is wanted: `play --help` stays instant.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
