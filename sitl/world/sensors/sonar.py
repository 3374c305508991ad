"""The ranger, swept by a servo.

Water. A level beam whose lower edge lies ½ w below its axis meets flat water height / tan ½ w away: 1.1 m for
an HC-SR04 15 cm above it. Flat water mirrors it on. In waves the axis leans with the hull, and a face that
rises away with the slope s, met at the grazing angle γ, is taken for as dull as it is steep: of a patch as
wide as the beam and as long as the pulse, l = 3.4 cm, it sends back 4 w l s sin γ / (π r) of what a mirror
there would (Lambert's law, Urick 1983, chapter 8, has sin γ for s). Light goes into the water.
"""

import math
from collections import deque

import msgspec

from companion.core.readings import SonarReading
from companion.sensors.servo_scan import ServoScan
from sitl.world.environment.waves import Waves
from sitl.world.movers import Movers
from sitl.world.sampling import TIME_SLACK_S, generator, normal
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.rangers import SonarSettings
from sitl.world.shore import Shore

_EDGE = 1.5  # cones: beyond, the beam is 13 dB down
_RAY_RAD = math.radians(7.5)  # from ray to ray, at most: a body of 0.3 m is 8.6° wide at 2 m
_NEAREST_M = 0.02  # for the logarithm
_SPRAY_M = 0.6  # water thrown up by the bow comes no further,
_SPRAY_RAD = math.radians(60.0)  # nor abaft
_WATER_M = (0.4, 0.7, 1.0, 1.4, 1.8, 2.4)  # where the surface is looked at, somewhat nearer or farther
_PULSE_M = 0.034  # eight periods of 40 kHz, there and back
_Echo = tuple[float, float]  # range in m, excess in dB


class SimSonar:
    """The swept ranger. The nearest echo that exceeds its threshold counts.

    mover_heard_s: when that was first a mover's.
    """

    def __init__(
        self, settings: SonarSettings, shore: Shore, seed: int, movers: Movers | None = None
    ) -> None:
        self.fault: SensorFault[SonarReading] | None = None
        self.clock_offset_s = 0.0  # the boat's clock, which stamps readings, less the world's
        self._settings = settings
        self._shore = shore
        self._movers = movers
        self._random, self._levels = generator(seed, "sonar"), generator(seed, "sonar.level")
        self._cone_rad = _EDGE * 0.5 * math.radians(settings.cone_deg)
        rays = math.ceil(self._cone_rad / _RAY_RAD - 1e-9)
        self._fan_rad = tuple(self._cone_rad * ray / max(rays, 1) for ray in range(-rays, rays + 1))
        self._patch_m = max(4.0 / math.pi * math.radians(settings.cone_deg) * _PULSE_M, 1e-9)
        self._per_rad2 = 6.0 / max(0.5 * math.radians(settings.cone_deg), 1e-9) ** 2
        self._grazing = math.cos(math.radians(settings.specular_deg)) if settings.specular_deg < 90.0 else 0.0
        self._swing = ServoScan(sweep_bearings_rad(settings))
        self._servo = _Servo(settings, self._swing.bearing_rad)
        self._pings: deque[SonarReading] = deque(maxlen=64)  # bounded when nothing reads it
        self._last_range_m: float | None = None
        self._count, self.due_s = 0, 0.0
        self.mover_heard_s = math.inf

    def sample(
        self, now_s: float, north_m: float, east_m: float, heading_rad: float, sea: Waves | None = None
    ) -> None:
        """Ping when due. sea: None is calm."""
        if now_s < self.due_s:
            return
        settings = self._settings
        bearing, points_rad = self._swing.bearing_rad, self._servo.at(now_s)
        self._servo.turn(now_s, self._swing.turn())
        self._count += 1
        self.due_s = self._count * settings.ping_s - TIME_SLACK_S
        waves = None if sea is None or sea.is_calm else sea
        from_movers = self._mover_echoes(heading_rad + points_rad, north_m, east_m, now_s)
        echoes = self._echoes(heading_rad + points_rad, north_m, east_m) + from_movers
        if waves is not None and not settings.is_light:
            echoes += self._water(waves, points_rad, heading_rad, north_m, east_m, now_s)
        heard_m = self._heard_m(echoes)
        if any(range_m == heard_m for range_m, _ in from_movers):
            self.mover_heard_s = min(self.mover_heard_s, now_s)
        if heard_m is not None:
            heard_m += settings.noise_m * normal(self._random)
        if settings.ghost_share or settings.spray_per_m:
            is_ahead = abs(points_rad) < _SPRAY_RAD
            heard_m = self._disturbed(heard_m, waves.height_m if waves is not None and is_ahead else 0.0)
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

    def _heard_m(self, echoes: list[_Echo]) -> float | None:
        """The nearest echo above the threshold. All echoes of a ping fluctuate alike."""
        if not echoes:
            return None
        least_db = self._settings.scatter_db * normal(self._levels)
        return min((range_m for range_m, excess_db in echoes if excess_db > least_db), default=None)

    def _echoes(self, ahead_rad: float, north_m: float, east_m: float) -> list[_Echo]:
        """Of shores."""
        most_m, echoes = self._settings.max_range_m, []
        rays_rad = [ahead_rad + side for side in self._fan_rad]
        found = self._shore.echoes(east_m, north_m, rays_rad, most_m, self._grazing)
        for off_rad, (range_m, radius_m) in zip(self._fan_rad, found, strict=False):
            if range_m <= most_m:
                echoes.append((range_m, self._excess_db(range_m, radius_m, off_rad)))
        return echoes

    def _mover_echoes(self, ahead_rad: float, north_m: float, east_m: float, now_s: float) -> list[_Echo]:
        if self._movers is None:
            return []
        found = self._movers.echoes(
            east_m, north_m, ahead_rad, self._cone_rad, self._settings.max_range_m, now_s
        )
        return [(range_m, self._excess_db(range_m, radius_m, off)) for range_m, radius_m, off in found]

    def _excess_db(self, range_m: float, radius_m: float, off_rad: float) -> float:
        """What an echo exceeds the threshold by, on average."""
        settings = self._settings
        range_m = max(range_m, _NEAREST_M)
        excess_db = 20.0 * math.log10(settings.half_range_m / range_m) - self._per_rad2 * off_rad * off_rad
        excess_db += 2.0 * settings.loss_db_m * (settings.half_range_m - range_m)
        if radius_m < math.inf and not settings.is_light:
            excess_db += 10.0 * math.log10(radius_m / (radius_m + range_m))
        return excess_db

    def _water(
        self, sea: Waves, points_rad: float, heading_rad: float, north_m: float, east_m: float, now_s: float
    ) -> list[_Echo]:
        """Of wave faces in the beam."""
        ahead_rad = heading_rad + points_rad
        cos, sin = math.cos(ahead_rad), math.sin(ahead_rad)
        rise = sea.pitch_rad * math.cos(points_rad) - sea.roll_rad * math.sin(points_rad)
        height_m, echoes = sea.heave_m + self._settings.height_m, []
        nearer = 0.85 + 0.3 * self._levels.random()
        for at_m in _WATER_M:
            range_m = nearer * at_m
            up_m, slope_n, slope_e = sea.surface(north_m + range_m * cos, east_m + range_m * sin, now_s)
            below = (height_m + range_m * rise - up_m) / range_m
            slope = slope_n * cos + slope_e * sin
            grazing = below + slope
            if below < self._cone_rad and slope > 0.0 < grazing:
                excess_db = self._excess_db(range_m, math.inf, max(below, 0.0))
                patch = self._patch_m * slope * math.sin(min(grazing, 0.5 * math.pi)) / range_m
                echoes.append((range_m, excess_db + 10.0 * math.log10(patch)))
            if below <= 0.0:  # the axis meets the face
                break
        return echoes

    def _disturbed(self, heard_m: float | None, wave_m: float) -> float | None:
        """With spray of waves so high. A fixed number of draws a ping makes pings independent."""
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
