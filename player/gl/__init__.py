"""OpenGL: contexts, shaders, framebuffers, memory and errors."""
