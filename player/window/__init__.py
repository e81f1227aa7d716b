"""The window: what it shows, its input, and what the input does."""

import lazy_loader

# GLFW and Dear ImGui load when a window opens: `play --help` stays instant.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
