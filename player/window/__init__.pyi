from .launch import LaunchOptions, start

__all__ = ["LaunchOptions", "start"]
