from .table import Namer, data_frame, measure_days, write_table
from .traits import Measurement, measure

__all__ = ["Measurement", "Namer", "data_frame", "measure", "measure_days", "write_table"]
