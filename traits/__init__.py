"""Traits of the plant in a growth clip: lengths, areas, angles and growth rates of its organs.

docs/traits.md says how they are measured, and describes the columns of the table.
"""

import lazy_loader

# numpy and scipy are imported when a trait is measured.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
