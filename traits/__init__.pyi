from .growth_rate import growth_rates
from .holdout_error import holdout_errors
from .speed import mean_speeds
from .table import NamedPlant, data_frame, measure_days, write_table
from .traits import Measurement, measure

__all__ = [
    "Measurement",
    "NamedPlant",
    "data_frame",
    "growth_rates",
    "holdout_errors",
    "mean_speeds",
    "measure",
    "measure_days",
    "write_table",
]
