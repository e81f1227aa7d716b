"""The growth clip: data model, file format and evaluation on the CPU (docs/format.md).

>>> import gclip
>>> clip = gclip.open("plant.gclip")  # doctest: +SKIP
>>> frame = clip.at(12.5)  # doctest: +SKIP
"""

import lazy_loader

__version__ = "0.1.0"  # read by pyproject.toml

# numpy and safetensors are imported when a clip is used, so that `--help` is fast.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
