"""Simulated receivers: from the truth to what the boat's parts would have said, by tick and seed alone.

Each sensor owns a random number generator seeded by the scenario's seed and the sensor's name, so that a
sensor more or less never shifts what another one hears. Settings are in the units of a scenario file
(degrees); everything handed on is in SI and radians.
"""

import math
import random
from collections import deque
from typing import Annotated

from msgspec import Meta

from companion.geo import LocalFrame, Point
from companion.section import NonNegative, Positive, Section
from companion.sensors.readings import GnssFix, HeadingReading, SonarReading
from companion.units import wrap_pi
from sitl.shore import Shore

EPOCH_UNIX_S = 1_767_225_600.0  # the simulated day is 1 January 2026, so that runs do not depend on the date
TIME_SLACK_S = 1e-6  # a sample that is due this soon is taken now: tick × dt need not hit a period exactly
CONE_RAYS = (-1.0, 0.0, 1.0)


class GnssSettings(Section, frozen=True):
    """A satellite receiver, or what stands in for one.

    Position error is white noise plus a first-order Gauss-Markov wander of the given deviation and
    correlation time, per axis. A fix carries the time it was valid for and arrives latency_s later.
    """

    rate_hz: Positive = 5.0
    noise_m: NonNegative = 0.10
    wander_m: NonNegative = 0.15
    wander_s: Positive = 60.0
    velocity_noise_m_s: NonNegative = 0.05
    latency_s: NonNegative = 0.1
    fix_type: Annotated[int, Meta(ge=0, le=6)] = 3
    satellites: Annotated[int, Meta(ge=0, le=60)] = 12
    hdop: Positive = 0.9


class CompassSettings(Section, frozen=True):
    """A magnetic compass with a yaw gyro: white noise and a fixed bias on each, clockwise positive."""

    rate_hz: Positive = 50.0
    noise_deg: NonNegative = 0.8
    bias_deg: float = 1.0
    gyro_noise_deg_s: NonNegative = 0.3
    gyro_bias_deg_s: float = 0.1


class SonarSettings(Section, frozen=True):
    """An ultrasonic ranger on a servo that sweeps to and fro over sweep_deg about the bow."""

    fitted: bool = True
    ping_s: Positive = 0.06
    sweep_deg: Annotated[float, Meta(ge=0.0, le=360.0)] = 180.0
    step_deg: Positive = 15.0
    cone_deg: Annotated[float, Meta(ge=0.0, le=90.0)] = 15.0
    min_range_m: NonNegative = 0.02
    max_range_m: Positive = 4.0
    noise_m: NonNegative = 0.01


class Sensors(Section, frozen=True):
    """The sensors aboard."""

    gnss: GnssSettings = GnssSettings()
    compass: CompassSettings = CompassSettings()
    sonar: SonarSettings = SonarSettings()


def generator(seed: int, name: str) -> random.Random:
    """A sensor's own random numbers."""
    return random.Random(f"{seed}/{name}")  # a string is hashed whole, and the same way in every process


class SimGnss:
    """The receiver: a queue of fixes on their way, and the latest that has arrived."""

    __slots__ = (
        "_drive_m",
        "_frame",
        "_keep",
        "_latest",
        "_next",
        "_random",
        "_settings",
        "_under_way",
        "_wander_e",
        "_wander_n",
    )

    def __init__(self, settings: GnssSettings, frame: LocalFrame, seed: int) -> None:
        """Start without a fix, the wander in its steady state."""
        self._settings = settings
        self._frame = frame
        self._random = generator(seed, "gnss")
        # The wander's share that lasts to the next fix, and the noise that keeps its deviation what it is.
        self._keep = math.exp(-1.0 / (settings.rate_hz * settings.wander_s))
        self._drive_m = settings.wander_m * math.sqrt(1.0 - self._keep * self._keep)
        self._under_way: deque[GnssFix] = deque()
        self._latest: GnssFix | None = None
        self._next = 0
        self._wander_n = self._random.gauss(0.0, settings.wander_m)
        self._wander_e = self._random.gauss(0.0, settings.wander_m)

    def sense(self, now_s: float, north_m: float, east_m: float, north_m_s: float, east_m_s: float) -> None:
        """Sample when due; deliver what has travelled long enough."""
        if now_s + TIME_SLACK_S >= self._next / self._settings.rate_hz:
            self._next += 1
            self._under_way.append(self._fix(now_s, north_m, east_m, north_m_s, east_m_s))
        under_way = self._under_way
        while under_way and now_s + TIME_SLACK_S >= under_way[0].time_s + self._settings.latency_s:
            self._latest = under_way.popleft()

    def _fix(self, now_s: float, north_m: float, east_m: float, north_m_s: float, east_m_s: float) -> GnssFix:
        settings, gauss = self._settings, self._random.gauss
        self._wander_n = self._keep * self._wander_n + gauss(0.0, self._drive_m)
        self._wander_e = self._keep * self._wander_e + gauss(0.0, self._drive_m)
        heard = Point(
            north_m + self._wander_n + gauss(0.0, settings.noise_m),
            east_m + self._wander_e + gauss(0.0, settings.noise_m),
        )
        return GnssFix(
            time_s=now_s,
            position=self._frame.to_global(heard),
            fix_type=settings.fix_type,
            satellites=settings.satellites,
            hdop=settings.hdop,
            north_m_s=north_m_s + gauss(0.0, settings.velocity_noise_m_s),
            east_m_s=east_m_s + gauss(0.0, settings.velocity_noise_m_s),
            horizontal_accuracy_m=math.hypot(settings.noise_m, settings.wander_m) * math.sqrt(2.0),
            unix_time_s=EPOCH_UNIX_S + now_s,
        )

    def read(self) -> GnssFix | None:
        """The latest fix that has arrived."""
        return self._latest

    def close(self) -> None:
        """Nothing to let go."""


class SimCompass:
    """Compass and gyro, read once per period."""

    __slots__ = (
        "_bias_rad",
        "_gyro_bias",
        "_gyro_noise",
        "_latest",
        "_next",
        "_noise_rad",
        "_random",
        "_rate_hz",
    )

    def __init__(self, settings: CompassSettings, seed: int) -> None:
        """Start without a reading."""
        self._random = generator(seed, "compass")
        self._rate_hz = settings.rate_hz
        self._noise_rad, self._bias_rad = math.radians(settings.noise_deg), math.radians(settings.bias_deg)
        self._gyro_noise = math.radians(settings.gyro_noise_deg_s)
        self._gyro_bias = math.radians(settings.gyro_bias_deg_s)
        self._latest: HeadingReading | None = None
        self._next = 0

    def sense(self, now_s: float, heading_rad: float, yaw_rate_rad_s: float) -> None:
        """Sample when due."""
        if now_s + TIME_SLACK_S < self._next / self._rate_hz:
            return
        self._next += 1
        gauss = self._random.gauss
        self._latest = HeadingReading(
            now_s,
            wrap_pi(heading_rad + self._bias_rad + gauss(0.0, self._noise_rad)),
            yaw_rate_rad_s + self._gyro_bias + gauss(0.0, self._gyro_noise),
        )

    def read(self) -> HeadingReading | None:
        """The latest reading."""
        return self._latest

    def close(self) -> None:
        """Nothing to let go."""


class SimSonar:
    """The swept ranger. Its cone is a fan of three rays of which the nearest echo counts."""

    __slots__ = ("_bearings_rad", "_fan_rad", "_next", "_pings", "_random", "_settings", "_shore")

    def __init__(self, settings: SonarSettings, shore: Shore, seed: int) -> None:
        """Start at the sweep's port end."""
        self._settings = settings
        self._shore = shore
        self._random = generator(seed, "sonar")
        self._fan_rad = tuple(0.5 * math.radians(settings.cone_deg) * side for side in CONE_RAYS)
        self._bearings_rad = sweep_bearings_rad(settings)
        self._pings: deque[SonarReading] = deque(maxlen=64)  # nobody reading must not cost memory
        self._next = 0

    def sense(self, now_s: float, north_m: float, east_m: float, heading_rad: float) -> None:
        """Ping when due."""
        settings = self._settings
        if now_s + TIME_SLACK_S < self._next * settings.ping_s:
            return
        bearing = self._bearings_rad[self._next % len(self._bearings_rad)]
        self._next += 1
        ahead = heading_rad + bearing
        echo: float | None = self._shore.range_m(
            east_m, north_m, [ahead + side for side in self._fan_rad], settings.max_range_m
        )
        if echo is not None and echo <= settings.max_range_m:
            heard = echo + self._random.gauss(0.0, settings.noise_m)
            echo = min(max(heard, settings.min_range_m), settings.max_range_m)
        else:
            echo = None
        self._pings.append(SonarReading(now_s, bearing, echo, settings.min_range_m, settings.max_range_m))

    def read(self) -> list[SonarReading]:
        """The pings since the last call, oldest first."""
        if not self._pings:
            return []
        pings = list(self._pings)
        self._pings.clear()
        return pings

    def close(self) -> None:
        """Nothing to let go."""


def sweep_bearings_rad(settings: SonarSettings) -> tuple[float, ...]:
    """One full sweep to and fro: from port to starboard and back, each end once."""
    steps = math.floor(settings.sweep_deg / settings.step_deg + 1e-9)
    out = [math.radians(settings.step_deg * (step - 0.5 * steps)) for step in range(steps + 1)]
    return tuple(out + out[-2:0:-1])
