"""Calibration of the yaw gyro's bias while the boat is at rest."""

from companion.core.readings import HeadingReading
from companion.core.status_text import Severity, StatusText
from companion.services.commands.command import Result

GYRO_S = 3.0
_MIN_READINGS = 20
_STILL_RAD_S = 0.1  # largest deviation from the mean at rest
MAX_BIAS_RAD_S = 0.2


class GyroCalibration:
    """Averages the gyro's readings. `result` is a MAV_RESULT when finished, None before."""

    def __init__(self, now_s: float) -> None:
        self.result: Result | None = None
        self.bias_rad_s = 0.0
        self.notice = StatusText(Severity.INFO, "")
        self._began_s = now_s
        self._last_s = now_s
        self._rates_rad_s: list[float] = []

    def progress_percent(self, now_s: float) -> int:
        return min(int(100.0 * (now_s - self._began_s) / GYRO_S), 99)

    def update(self, reading: HeadingReading | None, now_s: float) -> None:
        """Add the latest reading, as measured, before any trim."""
        if reading is not None and reading.yaw_rate_rad_s is not None and reading.time_s > self._last_s:
            self._last_s = reading.time_s
            self._rates_rad_s.append(reading.yaw_rate_rad_s)
        if now_s - self._began_s >= GYRO_S:
            self._finish()

    def _finish(self) -> None:
        rates = self._rates_rad_s
        if len(rates) < _MIN_READINGS:
            self._end(Result.FAILED, Severity.WARNING, "Gyro: the compass measures no yaw rate")
            return
        mean = sum(rates) / len(rates)
        if max(abs(rate - mean) for rate in rates) > _STILL_RAD_S or abs(mean) > MAX_BIAS_RAD_S:
            self._end(Result.FAILED, Severity.WARNING, "Gyro: the boat moved, not calibrated")
            return
        self.bias_rad_s = mean
        self._end(Result.ACCEPTED, Severity.NOTICE, "Gyro calibrated")

    def _end(self, result: Result, severity: int, text: str) -> None:
        self.result, self.notice = result, StatusText(severity, text)
