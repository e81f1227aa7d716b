"""Procedural plants with known truth: their shape, and where each point of it is, at any time."""

import lazy_loader

# numpy loads when a plant is grown: `grow --help` stays instant.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
