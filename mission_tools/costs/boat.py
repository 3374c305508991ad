"""A boat as the planner needs it, from its TOML: speeds, charge, and how much of a fence it holds."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from companion.config.boat_config import BoatConfig, decode_config, load_toml
from mission_tools.costs.travel import BoatSpeed, Floats
from mission_tools.costs.windage import InWind, in_wind
from mission_tools.errors import UsageError
from mission_tools.maps.catalogue import emulator_folder

BRUSHED, BRUSHLESS = (2.1, 2.7), (1.4, 1.95)
"""Exponents of the speed through the water for what the motors draw, below and above the speeds at which that
is known. A propeller's power grows with the cube of the speed, but at low thrust losses outweigh that do not
depend on it: a bridge's drop and friction, or a brushless motor's current without a load.

Fitted to three emulated hulls with brushed motors and to two with brushless ones, between 0.7 and 1.8 times
cruise speed (`python -m benchmarks.planning.voyages --draw`). At half of it steering takes more than the way:
the motors draw up to 40 % more than these say."""
FULL_THROTTLE = 0.85
"""Of handling.top_speed_m_s: a pair of a faster speed is of full throttle, of which steering takes its part
(0.90 to 0.99 of it are left to the same hulls)."""
STEERING = 1.08
"""What the motors draw on a route over what they draw on a straight line (the same hulls)."""
NO_DRAW = "set battery.cruise_a or battery.draw, what the boat draws, in its file"
HOLD_SHARE = 0.06
"""Of the motors' draw at cruise: what station keeping in still water takes (emulator, 80 s at a waypoint)."""


@dataclass(frozen=True, slots=True)
class Boat:
    """A boat by its configuration.

    draw: pairs of speed through still water in m/s and current in A on a route, all electronics included;
    empty where the file does not say. idle_a: with the motors stopped. exponents: of the speed, below and
    above these pairs. top_m_s: through the water, on a course: the last pair's, if that is of full throttle.
    reserve: share of the capacity that is never used. margin: times the charge for the way home that must be
    left, or the boat turns back by itself. fence_margin_m: how far inside the fence the boat stops.
    accel_m_s2: to a lower speed; to a higher one it is half as much again. least_radius_m: of its turns; 0:
    it turns on the spot. wind: that it sails in.
    """

    name: str
    cruise_m_s: float
    top_m_s: float
    slowest_m_s: float
    accel_m_s2: float
    corner_accel_m_s2: float
    turn_rate_rad_s: float
    least_radius_m: float
    waypoint_radius_m: float
    capacity_mah: float
    draw: tuple[tuple[float, float], ...]
    idle_a: float
    exponents: tuple[float, float]
    reserve: float
    margin: float
    fence_margin_m: float
    wind: InWind | None
    most_items: int
    most_fence_items: int
    most_rally_items: int

    @classmethod
    def of(cls, config: BoatConfig, name: str = "the boat", wind: str | None = None) -> "Boat":
        """A boat of this configuration, perhaps in a wind such as 6@270. Raises UsageError: as `in_wind`."""
        guidance, battery, cruise_m_s = config.guidance, config.battery, config.speed.cruise_m_s
        draw = battery.draw
        if not draw and battery.cruise_a > battery.idle_a:
            draw = ((cruise_m_s, battery.idle_a + STEERING * (battery.cruise_a - battery.idle_a)),)
        top_m_s = config.handling.top_speed_m_s
        if battery.draw and battery.draw[-1][0] > FULL_THROTTLE * top_m_s:
            top_m_s = battery.draw[-1][0]
        top_m_s = max(top_m_s, cruise_m_s)
        return cls(
            name,
            cruise_m_s=cruise_m_s,
            top_m_s=top_m_s,
            slowest_m_s=guidance.min_speed_m_s,
            accel_m_s2=guidance.accel_m_s2,
            corner_accel_m_s2=guidance.corner_accel_m_s2,
            turn_rate_rad_s=config.handling.turn_rate_rad_s,
            least_radius_m=config.drive.least_radius_m,
            waypoint_radius_m=guidance.waypoint_radius_m,
            capacity_mah=battery.capacity_mah,
            draw=draw,
            idle_a=battery.idle_a,
            exponents=BRUSHLESS if config.parts.motors.driver in ("esc", "vesc") else BRUSHED,
            reserve=config.failsafe.range_reserve,
            margin=config.failsafe.range_margin,
            fence_margin_m=config.fence.margin_m,
            wind=None if wind is None else in_wind(config, top_m_s, wind, name),
            most_items=config.mission.max_items,
            most_fence_items=config.mission.max_fence_items,
            most_rally_items=config.mission.max_rally_items,
        )

    @property
    def knows_its_draw(self) -> bool:
        """Whether a charge can be said at all."""
        return bool(self.draw)

    @property
    def usable_mah(self) -> float:
        """Of a full pack, without the reserve."""
        return (1.0 - self.reserve) * self.capacity_mah

    def speed(self, over_ground_m_s: float | None = None) -> BoatSpeed:
        """Its speeds; over_ground_m_s: in place of cruise. Raises UsageError: faster than the boat."""
        return BoatSpeed(over_ground_m_s or self.cruise_m_s, self.top_m_s, self.slowest_m_s, self.wind)

    def drawn_a(self, through_m_s: Floats) -> Floats:
        """What the whole boat draws at a speed through still water, in A: the motors' part follows a power of
        the speed from pair to pair. NaN where the file does not say.
        """
        if not self.draw:
            return np.full_like(through_m_s, np.nan)
        speeds, motors = np.log(np.array(self.draw) - (0.0, self.idle_a)).T
        at = np.log(np.maximum(through_m_s, 1e-6))
        below, above = self.exponents
        beyond = below * np.minimum(at - speeds[0], 0.0) + above * np.maximum(at - speeds[-1], 0.0)
        drawn: Floats = self.idle_a + np.exp(np.interp(at, speeds, motors) + beyond)
        return drawn

    @property
    def motors_a(self) -> float:
        """What the motors draw at cruise speed."""
        return float(self.drawn_a(np.array([self.cruise_m_s]))[0]) - self.idle_a

    def held_a(self, current_m_s: float = 0.0) -> float:
        """What it draws while it keeps station in a current, in A: the bow in the wind, if there is one."""
        still = np.array([current_m_s])
        if self.wind is not None:
            into_rad = np.array([math.atan2(-self.wind.east_m_s, -self.wind.north_m_s)])
            still = self.wind.still_m_s(np.zeros(1), -np.maximum(still, 0.01), np.zeros(1), into_rad)
            still = np.minimum(still, self.top_m_s)
        return float(self.drawn_a(still)[0]) + HOLD_SHARE * self.motors_a


def load_boat(name: str | None, wind: str | None = None) -> Boat:
    """A boat's TOML, that of `boat-companion` or that of an emulated boat (also by name, such as `lake`).

    name: None for this project's boat as it is without a file. wind: that it sails in, such as 6@270. Raises
    ConfigError: names file and key. UsageError: no such boat, no such wind, or a boat of unknown windage.
    """
    if name is None:
        return Boat.of(BoatConfig(), wind=wind)
    path = Path(name)
    folder = emulator_folder("boats")
    if path.suffix.lower() != ".toml":
        if folder is None or not (folder / f"{name}.toml").is_file():
            known = ", ".join(sorted(file.stem for file in folder.glob("*.toml"))) if folder else "none"
            raise UsageError(f"--boat {name}: no such boat (there are: {known}), and no .toml file")
        path = folder / f"{name}.toml"
    tree = load_toml(path)
    if "hull" in tree:  # an emulated boat has the companion's configuration in a table
        vehicle = tree.get("vehicle")
        tree = vehicle if isinstance(vehicle, dict) else {}
    return Boat.of(decode_config(tree, str(path)), path.stem, wind)
