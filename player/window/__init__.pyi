from .app import LaunchOptions, start

__all__ = ["LaunchOptions", "start"]
