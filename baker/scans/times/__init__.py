"""The order and the times of scans."""

from baker.scans.times.conventions import Moment
from baker.scans.times.schedule import (
    Entry,
    FoundScans,
    Schedule,
    names_without_times,
    natural_key,
    schedule_in_time,
    schedule_scans,
)

__all__ = ["Entry", "FoundScans", "Moment", "Schedule", "schedule_in_time"]
__all__ += ["names_without_times", "natural_key", "schedule_scans"]
