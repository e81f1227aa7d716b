"""The report of a bake: one self-contained HTML file."""

from baker.report.page import write_report

__all__ = ["write_report"]
