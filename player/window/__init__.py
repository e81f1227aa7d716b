"""The application window: its event loop, views of clips, exports and settings."""

import lazy_loader

# Submodules are imported on first use to keep `play --help` fast.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
