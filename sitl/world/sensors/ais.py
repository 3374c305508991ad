"""The AIS receiver, and the transponders of the movers that have one."""

import math

from companion.core.geo import LocalFrame, Point
from companion.core.readings import AisReading, AisVessel
from sitl.world.movers import Movers
from sitl.world.sampling import generator, normal
from sitl.world.sensors.sensor import Sensor
from sitl.world.sensors.settings import AisSettings

_MMSI = 235_000_001  # of the first mover
_STEP_S = 0.1  # over which course and speed are measured
_RATE_HZ = 1.0  # at which the transponders are looked at
_INTERVALS_S = {"A": 10, "B": 30, "none": 1}  # under way, up to 14 knots (ITU-R M.1371-5, tables 1 and 2)


class SimAis(Sensor[AisReading]):
    """Each transponder reports at seconds of its own; some reports are lost."""

    def __init__(self, settings: AisSettings, frame: LocalFrame, movers: Movers, seed: int) -> None:
        super().__init__()
        self._settings, self._frame, self._movers = settings, frame, movers
        self._random = random = generator(seed, "ais")
        self._begins_s = [int(random.uniform(0.0, _INTERVALS_S[one])) for one in movers.transponders]
        self._heard: dict[int, AisVessel] = {}

    def sample(self, now_s: float) -> None:
        """Report and receive, when due."""
        if not self._is_due(now_s, _RATE_HZ):
            return
        for number, kind in enumerate(self._movers.transponders):
            noise_m = Point(*(self._settings.noise_m * normal(self._random) for _ in range(2)))
            is_lost = self._random.random() < self._settings.lost_share
            is_due = (self._count - 1) % _INTERVALS_S[kind] == self._begins_s[number]
            if kind != "none" and is_due and not is_lost:
                vessel = self._heard[number] = self._report(number, kind, noise_m, now_s)
                self._output(AisReading(vessel.time_s, tuple(self._heard.values())), now_s)

    def _report(self, number: int, kind: str, noise_m: Point, now_s: float) -> AisVessel:
        (east_m, north_m, radius_m), (then_east_m, then_north_m, _) = (
            self._movers.positions_m(at_s)[number] for at_s in (now_s, now_s + _STEP_S)
        )
        side_m = math.ceil(radius_m)
        return AisVessel(
            _MMSI + number,
            now_s + self.clock_offset_s,
            self._frame.to_global(Point(north_m + noise_m.north_m, east_m + noise_m.east_m)),
            speed_m_s=math.hypot(then_north_m - north_m, then_east_m - east_m) / _STEP_S,
            course_rad=math.atan2(then_east_m - east_m, then_north_m - north_m) % math.tau,
            status=0,
            is_class_b=kind == "B",
            error_m=13.0,  # without corrections
            name=f"MOVER {number + 1}" if kind == "A" else "",
            bow_m=side_m,
            stern_m=side_m,
            port_m=side_m,
            starboard_m=side_m,
        )
