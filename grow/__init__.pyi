from .kinds import KINDS
from .model import plant

__all__ = ["KINDS", "plant"]
