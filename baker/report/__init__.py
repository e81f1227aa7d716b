"""The report of a bake: one HTML file for a researcher, which opens anywhere, offline."""

from baker.report.page import write_report

__all__ = ["write_report"]
