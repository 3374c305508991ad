"""Heading from two GNSS antennas: the moving baseline of a u-blox pair, or NMEA sentences."""

import math
from collections.abc import Callable
from typing import Final

import msgspec

from companion.core.readings import GnssFix, HeadingReading
from companion.core.units import wrap_pi
from companion.sensors.receiver_clock import ReceiverClock
from companion.sensors.silence import SilenceMonitor
from companion.sensors.ubx.messages import Baseline

# A fixed baseline is known to a centimetre; this covers a length measured with a tape. The lengths of wrong
# ambiguities differ by a carrier wavelength, 0.19 m on L1.
LENGTH_TOLERANCE_M: Final = 0.1
WORST_ACCURACY_RAD: Final = math.radians(5.0)  # a magnetic compass is as good
_LOST_S: Final = 3.0  # without an accepted heading, before the operator is told;
_FIRST_S: Final = 60.0  # of the first one: a cold start takes half a minute, the ambiguities as long
_DAY_S: Final = 86_400.0


class GnssHeading:
    """latest: the latest accepted heading; messages when it is lost and when it is back."""

    def __init__(
        self,
        antenna_bearing_rad: float = 0.0,
        baseline_m: float = 0.0,
        latency_s: float = 0.0,
        fallback: str = "none",
        timeout_s: float = 1.5,
    ) -> None:
        """antenna_bearing_rad: direction from the reference antenna to the receiver's own, from the bow.

        baseline_m: distance of the antennas; 0: any. fallback: what is used instead, for the messages.
        timeout_s: the heading is silent after so long.
        """
        self.latest: HeadingReading | None = None
        self.timeout_s = timeout_s
        self._antenna_bearing_rad = antenna_bearing_rad
        self._fallback = "" if fallback == "none" else f"; using {fallback}"
        self._baseline_m = baseline_m
        self._latency_s = latency_s
        self._clock = ReceiverClock(latency_s)
        self._accuracy_rad: float | None = None
        self._accepted_s = -math.inf
        self._due_s = math.inf  # of the message about a lost heading
        self._fault = "no heading from the receiver"
        self._silence = SilenceMonitor("GNSS heading", again="is back")

    def on_baseline(self, baseline: Baseline, time_s: float) -> None:
        """A solution of the moving baseline has arrived."""
        self._fault = self._fault_of(baseline)
        if self._fault or baseline.heading_rad is None:
            return
        measured_s = self._clock.measured_s(baseline.time_of_week_s % _DAY_S, time_s)
        self._accuracy_rad = baseline.accuracy_rad
        self._accept(measured_s, baseline.heading_rad, None, time_s)

    def on_sentence(self, reading: HeadingReading) -> None:
        """A sentence with a heading has arrived."""
        time_s = reading.time_s
        self._accept(time_s - self._latency_s, reading.heading_rad, reading.yaw_rate_rad_s, time_s)

    def added_to(self, fix: GnssFix, time_s: float) -> GnssFix:
        """The fix with the present heading, if there is one."""
        if self.latest is None or time_s - self._accepted_s > self.timeout_s:
            return fix
        return msgspec.structs.replace(
            fix, heading_rad=self.latest.heading_rad, heading_accuracy_rad=self._accuracy_rad
        )

    def tick(self, now_s: float, notify: Callable[[int, str], None]) -> None:
        """Tell the operator about a lost heading, and about its return."""
        if self._due_s == math.inf:
            self._due_s = now_s + _FIRST_S
        what = f"lost: {self._fault or 'receiver silent'}{self._fallback}"
        if text := self._silence.update(0.0, now_s, is_heard=now_s <= self._due_s, what=what):
            notify(*text)

    def _accept(self, measured_s: float, heading_rad: float, rate_rad_s: float | None, time_s: float) -> None:
        self.latest = HeadingReading(measured_s, wrap_pi(heading_rad - self._antenna_bearing_rad), rate_rad_s)
        self._accepted_s, self._fault = time_s, ""
        self._due_s = time_s + _LOST_S

    def _fault_of(self, baseline: Baseline) -> str:
        """Why a baseline is not accepted; empty if it is."""
        if baseline.heading_rad is None:
            return "no baseline between the antennas"
        if not baseline.is_fixed:
            return "baseline not fixed"
        if self._baseline_m and abs(baseline.length_m - self._baseline_m) > LENGTH_TOLERANCE_M:
            return f"baseline {baseline.length_m:.2f} m, expected {self._baseline_m:.2f} m"
        if baseline.accuracy_rad > WORST_ACCURACY_RAD:
            return f"accuracy {math.degrees(baseline.accuracy_rad):.0f} degrees"
        return ""
