from .start import Wanted, start

__all__ = ["Wanted", "start"]
