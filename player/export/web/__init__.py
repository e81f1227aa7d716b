"""Exports a clip as one HTML page that plays it."""
