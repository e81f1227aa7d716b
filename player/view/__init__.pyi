from .annotations import Annotations
from .camera_animation import load_path

__all__ = ["Annotations", "load_path"]
