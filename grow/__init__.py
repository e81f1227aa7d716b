"""Procedural plants whose shape, and the position of each point, is known at any time."""

import lazy_loader

# numpy is imported when a plant is grown, so that `grow --help` is fast.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
