from .table import NamedPlant, data_frame, measure_days, write_table
from .traits import Measurement, measure

__all__ = ["Measurement", "NamedPlant", "data_frame", "measure", "measure_days", "write_table"]
