from .errors import InputError
from .options import Options
from .pipeline import bake

__all__ = ["InputError", "Options", "bake"]
