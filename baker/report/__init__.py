"""The report of a bake: one self-contained HTML file."""
