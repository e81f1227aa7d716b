"""The panel, the timeline, the help and the annotations over the picture."""
