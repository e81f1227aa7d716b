"""The baker: scans of a growing plant in, a growth clip out.

from baker import bake, Options
clip = bake(["scans/"], Options(decay="fade"))
clip.save("plant.gclip")
"""

from typing import TYPE_CHECKING, Any

from baker.errors import InputError
from baker.options import Options

if TYPE_CHECKING:
    from baker.pipeline import bake

__all__ = ["InputError", "Options", "bake"]


def __getattr__(name: str) -> Any:
    """Load the pipeline, and numpy with it, only when something is baked."""
    if name == "bake":
        from baker.pipeline import bake

        return bake
    raise AttributeError(f"module 'baker' has no attribute {name!r}")
