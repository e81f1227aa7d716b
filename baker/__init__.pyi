from .batch.api import bake
from .errors import InputError
from .options import Options

__all__ = ["InputError", "Options", "bake"]
