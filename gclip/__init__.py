"""The growth clip: data model, file, and evaluation on the CPU (docs/format.md).

import gclip
clip = gclip.open("plant.gclip")   # memory-mapped and fully checked, or gclip.ClipError
frame = clip.at(12.5)              # the plant on day 12.5, the same maths as the shader
"""

import lazy_loader

# numpy and the container library load when a clip is touched: `--help` stays instant.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
