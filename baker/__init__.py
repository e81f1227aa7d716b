"""The baker: scans of a growing plant in, a growth clip out.

from baker import bake, Options
clip = bake(["scans/"], Options(decay="fade"))
clip.save("plant.gclip")
"""

import lazy_loader

# numpy and the stages load when something is baked: `bake --help` stays instant.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
