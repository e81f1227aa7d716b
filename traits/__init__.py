"""Numbers from a growth clip: how long, how large, how fast, organ by organ (docs/exports.md).

Uses gclip and scipy; the baker and the player both use it, and it knows neither.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from traits.table import measure_days, write_table
    from traits.traits import Measurement, measure

__all__ = ["Measurement", "measure", "measure_days", "write_table"]

_HOME = {
    "Measurement": "traits.traits",
    "measure": "traits.traits",
    "measure_days": "traits.table",
    "write_table": "traits.table",
}


def __getattr__(name: str) -> Any:
    """Load numpy and scipy only when something is measured."""
    if name not in _HOME:
        raise AttributeError(f"module 'measure' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOME[name]), name)
