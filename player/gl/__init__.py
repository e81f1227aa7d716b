"""OpenGL contexts, shaders, framebuffers, timers, memory and errors."""
