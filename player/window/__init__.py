"""The application window: its event loop, views of clips, exports and settings."""
