"""Traits of the plant in a growth clip: lengths, areas, angles and growth rates of its organs.

Baker and player both use this package; it knows gclip alone. docs/exports.md describes the table.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from traits.table import Namer, measure_days, write_table
    from traits.traits import Measurement, measure

__all__ = ["Measurement", "Namer", "measure", "measure_days", "write_table"]

_HOME = {
    "Measurement": "traits.traits",
    "Namer": "traits.table",
    "measure": "traits.traits",
    "measure_days": "traits.table",
    "write_table": "traits.table",
}


def __getattr__(name: str) -> Any:
    """Load numpy and scipy only when a trait is measured."""
    if name not in _HOME:
        raise AttributeError(f"module 'traits' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOME[name]), name)
