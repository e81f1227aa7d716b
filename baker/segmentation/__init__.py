"""Segment scans into organs, and build their hierarchies (section 3.2 of the paper)."""
