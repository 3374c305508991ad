"""The satellite receiver, or what stands in for one, with the driver's clock that dates its fixes.

What a receiver states as its accuracy is a model of its own, by class of fix and geometry, whatever its
errors are just then: HDOP times the user-equivalent range error of the class (E. D. Kaplan, C. J. Hegarty,
*Understanding GPS/GNSS*, 3rd ed. 2017, section 11.2), in steps of GST's usual decimal. With 1.2 m a
single-band receiver at HDOP 0.9 states 1.1 m, as a u-blox M8 does under open sky.
"""

import math
import random
from collections import deque

import msgspec

from companion.core.geo import LocalFrame, Point
from companion.core.readings import GnssFix
from companion.core.units import clamp
from companion.sensors.receiver_clock import DAY_S, ReceiverClock
from sitl.world.sampling import EPOCH_UNIX_S, TIME_SLACK_S, generator, normal
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.receivers import GnssSettings
from sitl.world.sensors.sensor import Sensor
from sitl.world.shore import Shore

_MULTIPATH_S = 15.0  # reflections change with the boat's place and the satellites' as slowly as this
_JAMMED_NOISE_M = 8.0  # when the jammer is about to win
_MOST_M = 1e6  # that a fault moves a fix: it stays on the globe
_FULL_SCALE_M, _FULL_SCALE_M_S = 32_768.0, 327.68  # of a corrupt fix, by north and east
_NO_FIX = 1  # GPS_FIX_TYPE_NO_FIX
# Range error in m and decimal step in m, by GPS_FIX_TYPE: DGNSS, RTK float, RTK fixed; the rest by itself.
_STATED = {4: (0.7, 0.1), 5: (0.3, 0.1), 6: (0.015, 0.005)}
_STATED_ALONE = (1.2, 0.1)


class SimGnss(Sensor[GnssFix]):
    """The receiver: a queue of fixes on their way, and the latest that has arrived."""

    def __init__(
        self,
        settings: GnssSettings,
        frame: LocalFrame,
        seed: int,
        shore: Shore | None = None,
        assumed_latency_s: float = 0.0,
    ) -> None:
        """Start without a fix, the wander in its steady state.

        assumed_latency_s: what the boat's configuration takes for the receiver's shortest delay.
        """
        super().__init__()
        self._clock = ReceiverClock(assumed_latency_s)
        self._assumed_latency_s = assumed_latency_s
        self._delays = generator(seed, "gnss.delay")
        self._settings = settings
        self._frame = frame
        self._random = generator(seed, "gnss")
        self._accuracy_m = stated_accuracy_m(settings.fix_type, settings.hdop)
        self._under_way: deque[tuple[float, GnssFix]] = deque(maxlen=1024)
        self._next_s = 0.0
        period_s = 1.0 / settings.rate_hz
        self._wander = _GaussMarkov(self._random, settings.wander_m, settings.wander_s, period_s)
        self._slow = _GaussMarkov(generator(seed, "gnss.slow"), settings.slow_m, settings.slow_s, period_s)
        self._velocity = _GaussMarkov(
            self._random, settings.velocity_noise_m_s, settings.velocity_noise_s, period_s, is_settled=False
        )
        self._multipath: _Multipath | None = None
        if shore is not None and settings.multipath_m:
            self._multipath = _Multipath(settings, shore, generator(seed, "gnss.multipath"))

    def sample(self, now_s: float, north_m: float, east_m: float, north_m_s: float, east_m_s: float) -> None:
        """Sample when due; deliver fixes whose latency has passed."""
        if now_s < self.due_s:
            return
        if now_s >= self._next_s:
            self._count += 1
            self._next_s = self._count / self._settings.rate_hz - TIME_SLACK_S
            self._sample(now_s, north_m, east_m, north_m_s, east_m_s)
        under_way = self._under_way
        while under_way and now_s >= under_way[0][0]:
            arrived = msgspec.structs.replace(under_way.popleft()[1], time_s=now_s + self.clock_offset_s)
            self._latest = self._clock.stamp(arrived)
        self.due_s = min(self._next_s, under_way[0][0]) if under_way else self._next_s

    def _sample(self, now_s: float, north_m: float, east_m: float, north_m_s: float, east_m_s: float) -> None:
        fix: GnssFix | None = self._fix(now_s, north_m, east_m, north_m_s, east_m_s)
        if self.fault is None:
            self._sampled = fix
        elif fix is not None:
            fix = self._with_fault(fix, self.fault, now_s)
        if fix is not None:
            settings, under_way = self._settings, self._under_way
            arrives_s = now_s + settings.latency_s + settings.jitter_s * self._delays.random() - TIME_SLACK_S
            if under_way:  # a serial line keeps the order
                arrives_s = max(arrives_s, under_way[-1][0])
            under_way.append((arrives_s, fix))

    def _fix(self, now_s: float, north_m: float, east_m: float, north_m_s: float, east_m_s: float) -> GnssFix:
        settings, numbers = self._settings, self._random
        wander, slow, velocity = self._wander, self._slow, self._velocity
        wander.step()
        slow.step()
        heard_n = north_m + wander.north + slow.north + settings.noise_m * normal(numbers)
        heard_e = east_m + wander.east + slow.east + settings.noise_m * normal(numbers)
        velocity.step()
        if self._multipath is not None:
            off_n, off_e = self._multipath.error_m(north_m, east_m)
            heard_n, heard_e = heard_n + off_n, heard_e + off_e
        return GnssFix(
            time_s=math.nan,  # the driver dates it on arrival
            position=self._frame.to_global(Point(heard_n, heard_e)),
            fix_type=settings.fix_type,
            satellites=settings.satellites,
            hdop=settings.hdop,
            north_m_s=north_m_s + velocity.north,
            east_m_s=east_m_s + velocity.east,
            horizontal_accuracy_m=self._accuracy_m,
            speed_accuracy_m_s=settings.speed_accuracy_m_s or None,
            unix_time_s=EPOCH_UNIX_S + now_s,
            time_of_day_s=(EPOCH_UNIX_S % DAY_S + now_s) % DAY_S,
        )

    def _with_fault(self, fix: GnssFix, fault: SensorFault[GnssFix], now_s: float) -> GnssFix | None:
        """The fix with the fault. A deceived receiver reports its usual accuracy."""
        replace, since_s = msgspec.structs.replace, now_s - fault.since_s
        match fault.kind:
            case "stuck":
                held = fault.hold(self._sampled, fix)
                return replace(held, unix_time_s=fix.unix_time_s, time_of_day_s=fix.time_of_day_s)
            case "no_fix":
                return replace(fix, fix_type=_NO_FIX, satellites=2, hdop=99.0, north_m_s=None, east_m_s=None)
            case "garbage":
                uniform = fault.random.uniform
                return self._moved(fix, uniform(-fault.size, fault.size), uniform(-fault.size, fault.size))
            case "corrupt":
                return self._corrupt(fix, fault)
            case "wrong":
                return self._pulled(fix, fault, fault.size)
            case "drift":
                return self._pulled(fix, fault, fault.size * since_s)
            case "jammed" if since_s < fault.size:
                share, gauss = since_s / fault.size, fault.random.gauss
                noise_m = _JAMMED_NOISE_M * share
                noisy = self._moved(fix, gauss(0.0, noise_m), gauss(0.0, noise_m))
                fault.held = replace(
                    noisy,
                    satellites=max(4, round(fix.satellites * (1.0 - 0.6 * share))),
                    hdop=fix.hdop * (1.0 + 4.0 * share),
                    horizontal_accuracy_m=noise_m + (fix.horizontal_accuracy_m or 0.0),
                )
                return fault.held
            case "jammed":
                held = replace(fault.held or fix, fix_type=_NO_FIX, satellites=2, hdop=99.0)
                return replace(
                    held,
                    unix_time_s=fix.unix_time_s,
                    time_of_day_s=fix.time_of_day_s,
                    north_m_s=None,
                    east_m_s=None,
                )
            case _:
                late = fault.output_at(fix, now_s)
                # What the receiver itself holds back bears the time of day at which it comes out.
                return None if late is None else replace(late, time_of_day_s=fix.time_of_day_s)

    def _corrupt(self, fix: GnssFix, fault: SensorFault[GnssFix]) -> GnssFix:
        """Velocity, position or both. No protocol delivers a position that is not a number."""
        fixed = fault.corrupt(fix, north_m_s=_FULL_SCALE_M_S, east_m_s=_FULL_SCALE_M_S)
        if fixed is not fix and fault.random.random() < 0.5:
            here = self._frame.to_local(fix.position)
            north_m, east_m = (fault.garbled(at_m, _FULL_SCALE_M) for at_m in here)
            if math.isfinite(north_m + east_m):
                position = self._frame.to_global(Point(north_m, east_m))
                fixed = msgspec.structs.replace(fixed, position=position)
        return msgspec.structs.replace(fixed, unix_time_s=fix.unix_time_s, time_of_day_s=fix.time_of_day_s)

    def _pulled(self, fix: GnssFix, fault: SensorFault[GnssFix], by_m: float) -> GnssFix:
        return self._moved(fix, by_m * math.cos(fault.bearing_rad), by_m * math.sin(fault.bearing_rad))

    def _moved(self, fix: GnssFix, north_m: float, east_m: float) -> GnssFix:
        north_m, east_m = clamp(north_m, -_MOST_M, _MOST_M), clamp(east_m, -_MOST_M, _MOST_M)
        here = self._frame.to_local(fix.position)
        there = self._frame.to_global(Point(here.north_m + north_m, here.east_m + east_m))
        return msgspec.structs.replace(fix, position=there)

    def restart(self) -> None:
        """Forget all fixes: the boat's computer restarts."""
        super().restart()
        self._under_way.clear()
        self._clock = ReceiverClock(self._assumed_latency_s)


def stated_accuracy_m(fix_type: int, hdop: float) -> float:
    """The horizontal accuracy that a receiver reports for this GPS_FIX_TYPE and HDOP."""
    range_error_m, step_m = _STATED.get(fix_type, _STATED_ALONE)
    return step_m * max(1, round(hdop * range_error_m / step_m))


class _GaussMarkov:
    """Two independent first-order Gauss-Markov processes, north and east, step by step.

    deviation: of each; time_s: their time constant, 0 for white noise. is_settled: they begin in their steady
    state, not at 0.
    """

    def __init__(
        self,
        numbers: random.Random,
        deviation: float,
        time_s: float,
        step_s: float,
        *,
        is_settled: bool = True,
    ) -> None:
        self._random = numbers
        # The share that lasts to the next step, and the noise that keeps the deviation what it is
        self._keep = math.exp(-step_s / time_s) if time_s > 0.0 else 0.0
        self._drive = deviation * math.sqrt(1.0 - self._keep * self._keep)
        self.north = self.east = 0.0
        if is_settled:
            self.north, self.east = numbers.gauss(0.0, deviation), numbers.gauss(0.0, deviation)

    def step(self) -> None:
        """Advance by a step."""
        if self._drive:
            self.north = self._keep * self.north + self._drive * normal(self._random)
            self.east = self._keep * self.east + self._drive * normal(self._random)


class _Multipath:
    """Reflections off the shore: a wander whose deviation grows towards the water's edge."""

    def __init__(self, settings: GnssSettings, shore: Shore, numbers: random.Random) -> None:
        self._shore = shore
        self._size_m, self._reach_m = settings.multipath_m, settings.multipath_reach_m
        self._wander = _GaussMarkov(numbers, 1.0, _MULTIPATH_S, 1.0 / settings.rate_hz)

    def error_m(self, north_m: float, east_m: float) -> tuple[float, float]:
        """The error of the next fix, north and east."""
        self._wander.step()
        size_m = self._size_m * max(0.0, 1.0 - self._shore.room_m(east_m, north_m) / self._reach_m)
        return size_m * self._wander.north, size_m * self._wander.east
