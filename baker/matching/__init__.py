"""Match the segments of successive scans (section 3.3 of the paper), and track organs."""
