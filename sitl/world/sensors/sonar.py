"""The ultrasonic ranger, swept by a servo."""

import math
from collections import deque
from typing import Protocol

import msgspec

from companion.core.readings import SonarReading
from companion.sensors.servo_scan import ServoScan
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.sampling import TIME_SLACK_S, generator, normal
from sitl.world.sensors.settings import SonarSettings
from sitl.world.shore import Shore

CONE_RAYS = (-1.0, 0.0, 1.0)
_SPRAY_M = 0.6  # water thrown up by the bow comes no further


class MovingObstacles(Protocol):
    """What moves about on the water."""

    def range_m(
        self, east_m: float, north_m: float, bearings_rad: list[float], max_range_m: float, time_s: float
    ) -> float:
        """The nearest echo of a fan of rays from one point, infinite when there is none in range."""


class SimSonar:
    """The swept ranger. Its cone is a fan of three rays of which the nearest echo counts."""

    def __init__(
        self, settings: SonarSettings, shore: Shore, seed: int, movers: MovingObstacles | None = None
    ) -> None:
        self.fault: SensorFault[SonarReading] | None = None
        self.clock_offset_s = 0.0  # the boat's clock, which stamps readings, less the world's
        self._settings = settings
        self._shore = shore
        self._movers = movers
        self._random = generator(seed, "sonar")
        self._fan_rad = tuple(0.5 * math.radians(settings.cone_deg) * side for side in CONE_RAYS)
        self._grazing = math.cos(math.radians(settings.specular_deg)) if settings.specular_deg < 90.0 else 0.0
        self._swing = ServoScan(sweep_bearings_rad(settings))
        self._servo = _Servo(settings, self._swing.bearing_rad)
        self._pings: deque[SonarReading] = deque(maxlen=64)  # bounded when nothing reads it
        self._last_range_m: float | None = None
        self._count, self.due_s = 0, 0.0

    def sample(
        self, now_s: float, north_m: float, east_m: float, heading_rad: float, wave_m: float = 0.0
    ) -> None:
        """Ping when due. wave_m: the height of the waves."""
        if now_s < self.due_s:
            return
        settings = self._settings
        bearing, points_rad = self._swing.bearing_rad, self._servo.at(now_s)
        self._servo.turn(now_s, self._swing.turn())
        self._count += 1
        self.due_s = self._count * settings.ping_s - TIME_SLACK_S
        ahead = heading_rad + points_rad
        echo_m = self._echo_m([ahead + side for side in self._fan_rad], north_m, east_m, now_s)
        heard_m = None if echo_m is None else echo_m + settings.noise_m * normal(self._random)
        if settings.ghost_share or settings.spray_per_m:
            heard_m = self._disturbed(heard_m, wave_m)
        if heard_m is not None:
            heard_m = min(max(heard_m, settings.min_range_m), settings.max_range_m)
        ping = SonarReading(
            now_s + self.clock_offset_s, bearing, heard_m, settings.min_range_m, settings.max_range_m
        )
        if self.fault is None:
            self._last_range_m = heard_m
            self._pings.append(ping)
        else:
            faulty = self._with_fault(ping, self.fault, now_s)
            if faulty is not None:
                self._pings.append(faulty)

    def _echo_m(self, rays_rad: list[float], north_m: float, east_m: float, now_s: float) -> float | None:
        max_range_m = self._settings.max_range_m
        nearest_m = self._shore.range_m(east_m, north_m, rays_rad, max_range_m, self._grazing)
        if self._movers is not None:
            moving_m = self._movers.range_m(east_m, north_m, rays_rad, max_range_m, now_s)
            nearest_m = min(nearest_m, moving_m)
        return nearest_m if nearest_m <= max_range_m else None

    def _disturbed(self, heard_m: float | None, wave_m: float) -> float | None:
        """A fixed number of draws a ping: what one ping meets does not depend on another."""
        settings = self._settings
        sprayed, ghostly, where = self._random.random(), self._random.random(), self._random.random()
        if sprayed < settings.spray_per_m * wave_m:
            near_m = settings.min_range_m + where * _SPRAY_M
            return near_m if heard_m is None else min(near_m, heard_m)
        if ghostly < settings.ghost_share:
            return settings.min_range_m + where * (settings.max_range_m - settings.min_range_m)
        return heard_m

    def _with_fault(
        self, ping: SonarReading, fault: SensorFault[SonarReading], now_s: float
    ) -> SonarReading | None:
        replace = msgspec.structs.replace
        match fault.kind:
            case "stuck":
                return replace(ping, range_m=self._last_range_m)
            case "deaf":
                return replace(ping, range_m=None)
            case "garbage":
                return replace(ping, range_m=fault.random.uniform(ping.min_range_m, ping.max_range_m))
            case "corrupt":
                garbled = fault.corrupt(ping, range_m=2.0 * ping.max_range_m)
                is_echo = (garbled.range_m or 0.0) >= ping.min_range_m  # not for NaN
                return garbled if is_echo else replace(garbled, range_m=None)
            case "wrong":
                if ping.range_m is None:
                    return ping
                off_m = ping.range_m + fault.size
                return replace(ping, range_m=min(max(off_m, ping.min_range_m), ping.max_range_m))
            case _:
                return fault.output_at(ping, now_s)

    def read(self) -> list[SonarReading]:
        """The pings since the last call, oldest first."""
        if not self._pings:
            return []
        pings = list(self._pings)
        self._pings.clear()
        return pings

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """Sweep between these bearings."""
        self._swing.set_sector(port_rad, starboard_rad)

    def restart(self) -> None:
        """Forget all pings: the boat's computer restarts."""
        self._pings.clear()

    def close(self) -> None:
        """Nothing to close."""


class _Servo:
    """It starts to turn after a dead time and turns at a constant rate."""

    def __init__(self, settings: SonarSettings, bearing_rad: float) -> None:
        self._dead_s, self._rate_rad_s = settings.servo_dead_s, math.radians(settings.servo_deg_s)
        self._here_rad = self._before_rad = self._aim_rad = bearing_rad
        self._told_s = 0.0

    def at(self, now_s: float) -> float:
        """Its bearing now."""
        since_s = now_s - self._told_s
        here_rad = self._towards(self._here_rad, self._before_rad, min(since_s, self._dead_s))
        return self._towards(here_rad, self._aim_rad, max(since_s - self._dead_s, 0.0))

    def turn(self, now_s: float, bearing_rad: float) -> None:
        """Command another bearing."""
        self._here_rad = self.at(now_s)
        self._before_rad, self._aim_rad, self._told_s = self._aim_rad, bearing_rad, now_s

    def _towards(self, here_rad: float, aim_rad: float, for_s: float) -> float:
        reach_rad = self._rate_rad_s * for_s
        return here_rad + min(max(aim_rad - here_rad, -reach_rad), reach_rad)


def sweep_bearings_rad(settings: SonarSettings) -> tuple[float, ...]:
    """One full sweep to and fro: from port to starboard and back, each end once."""
    steps = math.floor(settings.sweep_deg / settings.step_deg + 1e-9)
    out = [math.radians(settings.step_deg * (step - 0.5 * steps)) for step in range(steps + 1)]
    return tuple(out + out[-2:0:-1])
