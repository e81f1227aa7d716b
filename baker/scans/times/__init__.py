"""The order and the times of scans."""
