"""Bake scans of a growing plant into a growth clip.

>>> from baker import bake, Options
>>> clip = bake(["scans/"], Options(decay="fade"))  # doctest: +SKIP
>>> clip.save("plant.gclip")  # doctest: +SKIP
"""

import lazy_loader

# numpy and the stages are imported when something is baked, so that `bake --help` is fast.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
