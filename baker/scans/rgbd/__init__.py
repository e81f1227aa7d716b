"""Read series of colour and depth images from a fixed camera (the Komatsuna dataset)."""
