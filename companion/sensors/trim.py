"""Corrects the heading sensor by its calibration."""

from companion.config.boat_config import Trim
from companion.sensors.readings import HeadingReading


def trimmed(reading: HeadingReading | None, trim: Trim) -> HeadingReading | None:
    """The reading with heading trim and gyro bias applied."""
    if reading is None or (trim.heading_rad == 0.0 and trim.gyro_bias_rad_s == 0.0):
        return reading
    rate = reading.yaw_rate_rad_s
    return HeadingReading(
        reading.time_s,
        reading.heading_rad + trim.heading_rad,
        None if rate is None else rate - trim.gyro_bias_rad_s,
    )
