"""A second ranger in the emulator: a MAVLink component that sends what it measures to the boat."""

import math

from companion.links.interfaces import Link
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect
from sitl.world.sampling import TIME_SLACK_S, generator, normal
from sitl.world.sensors.settings import LidarSettings
from sitl.world.world import World

_RAYS = 72  # of an OBSTACLE_DISTANCE
_UNKNOWN_CM = 0xFFFF
_SENSOR_ID = 1
_SCATTER_DB = 3.0
_NEAREST_M = 0.01  # for the logarithm


class LidarComponent:
    """Sends OBSTACLE_DISTANCE, or DISTANCE_SENSOR for one beam. mover_heard_s: of the first mover met."""

    def __init__(self, settings: LidarSettings, seed: int, system_id: int) -> None:
        self._settings = settings
        self._random, self._levels = generator(seed, "lidar"), generator(seed, "lidar.level")
        self._encoder = Encoder(Address(system_id, dialect.MAV_COMP_ID_OBSTACLE_AVOIDANCE))
        self._link: Link | None = None
        self._due_s = 0.0
        self.mover_heard_s = math.inf
        steps = math.floor(settings.field_deg / settings.step_deg + 1e-9)
        self._first_deg = -0.5 * steps * settings.step_deg
        self._rays_deg = [self._first_deg + step * settings.step_deg for step in range(min(steps + 1, _RAYS))]

    def connect(self, link: Link) -> None:
        """Use another link: the previous one ended with the boat's program."""
        self._link = link

    def step(self, world: World) -> None:
        """Measure and send if due."""
        link = self._link
        if link is None:
            return
        link.receive()  # it does not listen
        if world.time_s < self._due_s:
            return
        self._due_s = world.time_s + 1.0 / self._settings.rate_hz - TIME_SLACK_S
        ranges_cm = [self._range_cm(world, math.radians(ray_deg)) for ray_deg in self._rays_deg]
        message = self._scan(world, ranges_cm) if len(ranges_cm) > 1 else self._beam(world, ranges_cm[0])
        link.send(self._encoder.encode(message))

    def _range_cm(self, world: World, ray_rad: float) -> int:
        """Greatest range + 1 without an echo."""
        settings, truth = self._settings, world.truth
        most_m, bearing = settings.max_range_m, truth.heading_rad + ray_rad
        at = (truth.east_m, truth.north_m)
        movers = world.movers.echoes(*at, bearing, 0.0, most_m, world.time_s)
        range_m = min([world.shore.range_m(*at, [bearing], most_m), *(away_m for away_m, _, _ in movers)])
        noise, lost = settings.noise_m * normal(self._random), self._random.random() < settings.lost_share
        if lost or range_m > most_m:
            return round(100.0 * most_m) + 1
        excess_db = 20.0 * math.log10(settings.half_range_m / max(range_m, _NEAREST_M))
        if excess_db < _SCATTER_DB * normal(self._levels):
            return round(100.0 * most_m) + 1
        if any(away_m == range_m for away_m, _, _ in movers):
            self.mover_heard_s = min(self.mover_heard_s, world.time_s)
        return round(100.0 * min(max(range_m + noise, settings.min_range_m), most_m))

    def _scan(self, world: World, ranges_cm: list[int]) -> Message:
        settings = self._settings
        message: Message = dialect.MAVLink_obstacle_distance_message(
            time_usec=round(world.time_s * 1e6),
            sensor_type=dialect.MAV_DISTANCE_SENSOR_LASER,
            distances=ranges_cm + [_UNKNOWN_CM] * (_RAYS - len(ranges_cm)),
            increment=0,
            min_distance=round(100.0 * settings.min_range_m),
            max_distance=round(100.0 * settings.max_range_m),
            increment_f=settings.step_deg,
            angle_offset=self._first_deg,
            frame=dialect.MAV_FRAME_BODY_FRD,
        )
        return message

    def _beam(self, world: World, range_cm: int) -> Message:
        settings = self._settings
        most_cm = round(100.0 * settings.max_range_m)
        message: Message = dialect.MAVLink_distance_sensor_message(
            time_boot_ms=round(world.time_s * 1e3),
            min_distance=round(100.0 * settings.min_range_m),
            max_distance=most_cm,
            current_distance=min(range_cm, most_cm),
            type=dialect.MAV_DISTANCE_SENSOR_LASER,
            id=_SENSOR_ID,
            orientation=dialect.MAV_SENSOR_ROTATION_NONE,
            covariance=255,
            horizontal_fov=math.radians(settings.beam_deg),
        )
        return message
