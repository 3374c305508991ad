"""The AIS receiver, and the transponders of the movers that have one.

The sentences are written by pyais' encoder and read by the boat's own reader.
"""

import math
from importlib import import_module

from companion.core.geo import LocalFrame, Point
from companion.core.readings import AisReading
from companion.core.units import KNOT_M_S
from companion.sensors.nmea.ais import AisReader
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
        pyais = import_module("pyais")
        self._encode, self._reader = pyais.encode_dict, AisReader(pyais.decode)
        self._settings, self._frame, self._movers = settings, frame, movers
        self._random = random = generator(seed, "ais")
        self._begins_s = [int(random.uniform(0.0, _INTERVALS_S[one])) for one in movers.transponders]

    def sample(self, now_s: float) -> None:
        """Report and receive, when due."""
        if not self._is_due(now_s, _RATE_HZ):
            return
        said, second = b"", self._count - 1
        for number, kind in enumerate(self._movers.transponders):
            noise_m = [self._settings.noise_m * normal(self._random) for _ in range(2)]
            is_heard = self._random.random() >= self._settings.lost_share
            if is_heard and kind != "none" and second % _INTERVALS_S[kind] == self._begins_s[number]:
                said += self._report(number, kind, noise_m, now_s)
        reading = self._reader.feed(said, now_s + self.clock_offset_s)
        if reading is not None:
            self._output(reading, now_s)

    def _report(self, number: int, kind: str, noise_m: list[float], now_s: float) -> bytes:
        """The sentences of a mover's position and size."""
        (east_m, north_m, radius_m), (then_east_m, then_north_m, _) = (
            self._movers.positions_m(time_s)[number] for time_s in (now_s, now_s + _STEP_S)
        )
        way_m = then_north_m - north_m, then_east_m - east_m
        place = self._frame.to_global(Point(north_m + noise_m[0], east_m + noise_m[1]))
        position: dict[str, object] = {
            "msg_type": 1 if kind == "A" else 18,
            "lat": place.lat_deg,
            "lon": place.lon_deg,
            "speed": math.hypot(*way_m) / _STEP_S / KNOT_M_S,
            "course": math.degrees(math.atan2(way_m[1], way_m[0])) % 360.0,
            "heading": 511,
            "status": 0,
        }
        sides = {f"to_{side}": math.ceil(radius_m) for side in ("bow", "stern", "port", "starboard")}
        static = (
            {"msg_type": 5, "shipname": f"MOVER {number + 1}"}
            if kind == "A"
            else {"msg_type": 24, "partno": 1}
        )
        lines = [
            line
            for one in (position, static | sides)
            for line in self._encode({"mmsi": _MMSI + number, **one}, sentence_type="VDM")
        ]
        return "".join(f"{line}\r\n" for line in lines).encode("ascii")
