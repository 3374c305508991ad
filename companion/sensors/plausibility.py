"""Whether a reading is possible: within the limits of hull and part, and near the readings before it.

Wrong bits on a bus or a bad contact give single readings that are far off. A value beyond its bounds, or
farther from the last accepted one than the quantity can change, is rejected. A real change is accepted by the
third reading in a row that agrees with the one before it. A part that is wrong more often is erratic: none of
its values is used until they agree again. The evidence for that is a CUSUM (`companion.core.evidence`) of the
log likelihood ratio of "every second reading is wrong" against "one in a hundred".

Positions are judged by the estimator, which knows where the boat can be, and ranges by the map of echoes.
"""

import math
from collections.abc import Mapping
from typing import Final, Generic, NamedTuple, TypeVar

import msgspec

from companion.core.readings import BatteryReading, DepthReading, GnssFix, HeadingReading
from companion.core.units import wrap_pi

R = TypeVar("R", GnssFix, HeadingReading, BatteryReading, DepthReading)

_AGREE: Final = 3  # readings: two wrong ones in a row agree once in hours, three never
_WRONG: Final = math.log(0.5 / 0.01)  # nats for a reading that is far off,
_RIGHT: Final = math.log(0.99 / 0.5)  # and against it for one that is not
_ERRATIC: Final = 10.0  # nats: three wrong readings out of five; 15 good ones end it


class Limit(NamedTuple):
    """low, high: of the value. step + per_s × seconds: of its change. is_angle: in rad, and may wrap.

    missing: takes the place of a rejected value. is_needed: without the value the whole reading is rejected.
    """

    low: float
    high: float
    step: float = math.inf
    per_s: float = 1.0
    missing: float | None = None
    is_angle: bool = False
    is_needed: bool = False


_TURN_RAD_S: Final = math.tau  # the largest HND_TURN_RATE; hulls of a metre turn at 0.3 to 1.5 rad/s

# Steps are several times what waves, gusts and noise change between two readings of the part.
HEADING: Final = {
    # Full steering changes the rate by 1 rad/s² (Nomoto: 0.65 rad/s within 0.6 s)
    "yaw_rate_rad_s": Limit(-_TURN_RAD_S, _TURN_RAD_S, 0.2, 3.0),
    "heading_rad": Limit(-math.tau, math.tau, 0.2, 3.0, missing=math.nan, is_angle=True),
    # a hull that capsizes rolls by π within a second
    "roll_rad": Limit(-math.pi, math.pi, 0.5, math.tau, is_angle=True),
    "pitch_rad": Limit(-math.pi, math.pi, 0.5, math.tau, is_angle=True),
}
# A planing boat; 3 m/s² is a crash stop, 1.5 m/s the error of a receiver that sees its satellites anew
_VELOCITY: Final = Limit(-30.0, 30.0, 1.5, 3.0)
FIX: Final = {"north_m_s": _VELOCITY, "east_m_s": _VELOCITY}
# Up to 16 cells. The lake boat's two motors stall at 11 A; 40 A take 2 V from a pack of 50 mΩ.
# A larger motor's start is believed 0.2 s late
BATTERY: Final = {
    "voltage_v": Limit(0.0, 75.0, 2.0, 5.0, is_needed=True),
    "current_a": Limit(-500.0, 500.0, 10.0, 10.0, is_needed=True),
}
# The deepest ocean; at a ledge, soundings may differ by any depth
DEPTH: Final = {"depth_m": Limit(0.0, 11_000.0)}


class ValueGate:
    """Judges one quantity of one part."""

    __slots__ = ("_accepted", "_accepted_s", "_evidence", "_is_erratic", "_last", "_last_s", "_limit", "_run")

    def __init__(self, limit: Limit) -> None:
        self._limit = limit
        self._accepted = self._last = self._evidence = 0.0
        self._accepted_s = self._last_s = -math.inf
        self._run = 0  # readings in a row that agree
        self._is_erratic = False

    def accepts(self, value: float, time_s: float) -> bool:
        """Whether to use a reading. Any first one within the bounds is accepted."""
        limit = self._limit
        if not limit.low <= value <= limit.high:
            self._run = 0
            return self._reject()
        fits = not self._is_erratic and self._is_near(value - self._accepted, time_s - self._accepted_s)
        if fits and self._evidence == 0.0:  # nearly always
            self._accepted = self._last = value
            self._accepted_s = self._last_s = time_s
            return True
        agrees = self._is_near(value - self._last, time_s - self._last_s)
        self._last, self._last_s = value, time_s
        self._run = self._run + 1 if agrees else 1
        if not (fits or agrees):
            return self._reject()
        self._evidence = max(self._evidence - _RIGHT, 0.0)
        self._is_erratic = self._is_erratic and self._evidence > 0.0
        if self._is_erratic or not (fits or self._run >= _AGREE):
            return False
        self._accepted, self._accepted_s = value, time_s
        return True

    def _is_near(self, change: float, dt_s: float) -> bool:
        limit = self._limit
        if limit.is_angle:
            change = wrap_pi(change)
        return abs(change) <= limit.step + limit.per_s * dt_s

    def _reject(self) -> bool:
        self._evidence = min(self._evidence + _WRONG, _ERRATIC)
        self._is_erratic = self._is_erratic or self._evidence >= _ERRATIC
        return False


class ReadingGate(Generic[R]):
    """Judges the readings of one part."""

    def __init__(self, limits: Mapping[str, Limit]) -> None:
        self._gates = tuple((name, limit, ValueGate(limit)) for name, limit in limits.items())
        self._measured: R | None = None
        self._passed: R | None = None

    def judge(self, reading: R | None) -> R | None:
        """The latest plausible reading, without the values that are not; None without one.

        reading: the part's latest, which may be the previous one again.
        """
        if reading is not self._measured:
            self._measured = reading
            self._judge(reading)
        return self._passed

    def _judge(self, reading: R | None) -> None:
        if reading is None:
            self._passed = None
            return
        rejected: dict[str, float | None] = {}
        is_usable = True
        for name, limit, gate in self._gates:
            value = getattr(reading, name)
            if value is not None and not gate.accepts(value, reading.time_s):
                rejected[name] = limit.missing
                is_usable = is_usable and not limit.is_needed
        if is_usable:
            self._passed = msgspec.structs.replace(reading, **rejected) if rejected else reading
