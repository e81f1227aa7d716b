"""Rendering of a clip's points with OpenGL, on a screen or without one."""
