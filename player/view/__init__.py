"""What is looked at and how, without OpenGL and without a window: cameras, colors, playback."""
