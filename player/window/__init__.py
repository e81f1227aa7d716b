"""The window: what it shows, its input, and what the input does."""
