"""Everything outside the boat's computer: water, hull, thrusters, pack and sensors, one tick at a time.

    world = World(scenario)
    boat = Boat(config, world.hardware, …)
    each tick:  boat.step(world.time_s);  world.step(dt_s)

What a sensor says at a time is there to be read before the boat's step of that time. Nothing here looks at a
clock: the state is a function of the scenario and of the commands written to the motors.
"""

import math
import struct
from typing import NamedTuple

from companion.units import wrap_pi
from sitl.battery import Pack
from sitl.drive import Thrusters
from sitl.electronics import Electronics
from sitl.environment import Wind
from sitl.movers import Movers
from sitl.scenario import Scenario
from sitl.shore import Shore
from sitl.vessel import LONGEST_STEP_S, Vessel
from sitl.wind_knobs import WindKnobs
from sitl.windage import Windage

GROUNDED_S = 1.0  # a hull that rubs along the shore touches it now and then, and has run aground once
STATE = struct.Struct("<q13d")


class Truth(NamedTuple):
    """What is really so: the emulator's own knowledge, hidden from the boat.

    Position in the scenario's frame; heading in [−π, π), clockwise from north; surge and sway through the
    water, ahead and to starboard; north_m_s and east_m_s over ground; grounded: it touched the shore within
    the last second. Current and wind are the velocities of water and air over ground at the boat; the
    commands are those that stand at the motors, −1..1; voltage and current are the pack's.
    """

    time_s: float
    north_m: float
    east_m: float
    heading_rad: float
    surge_m_s: float
    sway_m_s: float
    yaw_rate_rad_s: float
    north_m_s: float
    east_m_s: float
    left_thrust_n: float
    right_thrust_n: float
    grounded: bool
    current_north_m_s: float = 0.0
    current_east_m_s: float = 0.0
    wind_north_m_s: float = 0.0
    wind_east_m_s: float = 0.0
    left_command: float = 0.0
    right_command: float = 0.0
    voltage_v: float = 0.0
    current_a: float = 0.0


class World:
    """One boat in its water."""

    def __init__(self, scenario: Scenario) -> None:
        """Put the boat at its start, at rest through the water, motors stopped, sensors sampled once."""
        seed = scenario.seed
        self.scenario = scenario
        self.shore = Shore(scenario.chart, max(1.0, scenario.sensors.sonar.max_range_m))
        self.tick = 0
        self.groundings = 0
        self._room_m = 0.0
        self._touched_s = -math.inf
        self._current_n = scenario.environment.current_north_m_s
        self._current_e = scenario.environment.current_east_m_s
        self._vessel = Vessel(
            scenario.hull, scenario.start.north_m, scenario.start.east_m, scenario.heading_rad
        )
        self.wind = Wind(scenario.environment, seed)
        self._windage = Windage(scenario.hull.windage, scenario.hull.length_m)
        self._thrusters = Thrusters(scenario.thrusters)
        self._pack = Pack(scenario.battery)
        self.movers = Movers(scenario.movers)
        self.electronics = Electronics(
            scenario,
            self.shore,
            self.movers,
            self._thrusters.left,
            self._thrusters.right,
            WindKnobs(scenario.environment, self.wind).knobs,
        )
        self.hardware = self.electronics.hardware
        self._motors = self.electronics.motors
        self._since_tick, self._since_s, self._dt_s = 0, 0.0, math.nan
        self.truth = self._observe(0.0)
        self.electronics.sense(self.truth)

    @property
    def time_s(self) -> float:
        """Simulated time since the start."""
        return self.truth.time_s

    @property
    def clock_s(self) -> float:
        """What the clock of the boat's computer shows."""
        return self.truth.time_s + self.electronics.computer.clock_offset_s

    @property
    def used_mah(self) -> float:
        """Charge taken from the pack since it was full."""
        return self._pack.used_mah

    def step(self, dt_s: float) -> Truth:
        """Advance by one tick; the truth at its end.

        Raises:
            ValueError: a step too long for the hull's integrator, or not a positive time.
        """
        if dt_s != self._dt_s:
            if not 0.0 < dt_s <= LONGEST_STEP_S:
                raise ValueError(f"a step of {dt_s} s: expected more than 0 and at most {LONGEST_STEP_S} s")
            # Time is counted, not summed: it is tick × dt exactly for as long as dt stays the same.
            self._since_tick, self._since_s, self._dt_s = self.tick, self.time_s, dt_s
        self.tick += 1
        motors, vessel = self._motors, self._vessel
        north_m, east_m = vessel.north_m, vessel.east_m
        force_n, moment_nm = self._thrusters.step(
            motors.left, motors.right, self._pack.supply_v, vessel.surge_m_s, vessel.yaw_rate_rad_s, dt_s
        )
        self._pack.step(self._thrusters.current_a, dt_s)
        if self.wind.is_calm:
            vessel.step(force_n, 0.0, moment_nm, self._current_n, self._current_e, dt_s)
        else:
            self.wind.step(self.time_s)
            surge_n, sway_n, yaw_nm = self._wind_force()
            vessel.step(force_n + surge_n, sway_n, moment_nm + yaw_nm, self._current_n, self._current_e, dt_s)
        time_s = self._since_s + (self.tick - self._since_tick) * dt_s
        if self._meets_shore(north_m, east_m) or (self.movers and self._meets_mover(time_s)):
            vessel.run_aground(north_m, east_m, self._current_n, self._current_e)
            self.groundings += not self.truth.grounded
            self._touched_s = time_s
        self.truth = truth = self._observe(time_s)
        self.electronics.sense(truth)
        return truth

    def _wind_force(self) -> tuple[float, float, float]:
        """Surge force, sway force and yaw moment of the air that moves past the hull."""
        truth, wind, heading = self.truth, self.wind, self._vessel.heading_rad
        north_m_s, east_m_s = wind.north_m_s - truth.north_m_s, wind.east_m_s - truth.east_m_s
        cos, sin = math.cos(heading), math.sin(heading)
        return self._windage.force(north_m_s * cos + east_m_s * sin, east_m_s * cos - north_m_s * sin)

    def _meets_shore(self, north_m: float, east_m: float) -> bool:
        """Whether the way from there to where the hull is now touches the shore.

        The distance to the shore, once measured, need not be measured again before that much way is made.
        """
        vessel = self._vessel
        self._room_m -= math.hypot(vessel.north_m - north_m, vessel.east_m - east_m)
        if self._room_m > 0.0:
            return False
        if self.shore.is_crossed(east_m, north_m, vessel.east_m, vessel.north_m):
            return True
        self._room_m = self.shore.room_m(vessel.east_m, vessel.north_m)
        return False

    def _meets_mover(self, time_s: float) -> bool:
        return self.movers.gap_m(self._vessel.east_m, self._vessel.north_m, time_s) <= 0.0

    def _observe(self, time_s: float) -> Truth:
        vessel = self._vessel
        north_m_s, east_m_s = vessel.velocity_m_s(self._current_n, self._current_e)
        return Truth(
            time_s,
            vessel.north_m,
            vessel.east_m,
            wrap_pi(vessel.heading_rad),
            vessel.surge_m_s,
            vessel.sway_m_s,
            vessel.yaw_rate_rad_s,
            north_m_s,
            east_m_s,
            self._thrusters.left.thrust_n,
            self._thrusters.right.thrust_n,
            time_s - self._touched_s < GROUNDED_S,
            self._current_n,
            self._current_e,
            self.wind.north_m_s,
            self.wind.east_m_s,
            self._motors.left,
            self._motors.right,
            self._pack.voltage_v,
            self._pack.current_a,
        )

    def state_bytes(self) -> bytes:
        """The physical state, packed: equal bytes mean an equal future, for equal commands and seed."""
        vessel, thrusters = self._vessel, self._thrusters
        return STATE.pack(
            self.tick,
            self.time_s,
            vessel.north_m,
            vessel.east_m,
            vessel.heading_rad,
            vessel.surge_m_s,
            vessel.sway_m_s,
            vessel.yaw_rate_rad_s,
            thrusters.left.speed_rad_s,
            thrusters.right.speed_rad_s,
            self._pack.used_mah,
            self._pack.voltage_v,
            self.wind.north_m_s,
            self.wind.east_m_s,
        )
