"""Export of a clip as an HTML page with a WebGL player."""
