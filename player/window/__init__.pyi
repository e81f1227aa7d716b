from .launch import start

__all__ = ["start"]
