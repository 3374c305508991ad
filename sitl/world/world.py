"""Everything outside the boat's computer: water, hull, thrusters, pack and sensors, one tick at a time.

    world = World(scenario)
    boat = Boat(config, world.hardware, …)
    each tick:  boat.step(world.time_s);  world.step(dt_s)

Sensor readings of a time are available before the boat's step of that time. No clock is read: the state is a
function of the scenario and of the motor commands.
"""

import math

from companion.core.errors import ConfigError
from companion.core.units import wrap_pi
from sitl.world.contact import Contact, Pose, Velocity
from sitl.world.drive.rudder import Rudder
from sitl.world.drive.thruster import Thrusters
from sitl.world.electronics import Electronics
from sitl.world.environment.current import Current
from sitl.world.environment.waves import Waves
from sitl.world.environment.wind import Wind
from sitl.world.hull import Hull
from sitl.world.hull_settings import LONGEST_STEP_S
from sitl.world.movers import Movers
from sitl.world.pack import Pack
from sitl.world.parameters import tide_hooks, wind_hooks
from sitl.world.scenario import Scenario
from sitl.world.shore import Shore
from sitl.world.truth import Truth
from sitl.world.windage import Windage

POWER_UP_S = 0.5  # the pack must be well for that long before the computer starts again
GROUNDED_S = 1.0  # a hull that rubs along the shore touches it now and then, and has run aground once
_FURTHEST_M = 1e6  # from the origin; the frame's formulas are good for less than a tenth of it
_new = tuple.__new__  # half the cost of a NamedTuple's own


class World:
    """One boat in its water."""

    def __init__(self, scenario: Scenario) -> None:
        """Put the boat at its start, at rest through the water, motors stopped, sensors sampled once."""
        seed = scenario.seed
        self.scenario = scenario
        hull, weather, start = scenario.hull, scenario.environment, scenario.start
        sensors = scenario.sensors
        sight_m = max(sensors.sonar.max_range_m, sensors.lidar.max_range_m if sensors.lidar.fitted else 0.0)
        self.shore = Shore(scenario.chart, max(1.0, hull.length_m, sight_m))
        self.tick = 0
        self._is_moored = False
        self.groundings = 0
        self._touched_s = -math.inf
        self._current = Current(weather)
        self._current_n, self._current_e = self._current.at(start.north_m, start.east_m, 0.0)
        self.wind = Wind(weather, seed)
        self.waves = Waves(weather, hull.length_m, seed)
        self._is_open = not (self._current.is_uniform and self.waves.is_calm)
        self._flow_n, self._flow_e = (
            self._current_n + self.waves.north_m_s,
            self._current_e + self.waves.east_m_s,
        )
        self._hull = Hull(hull, start.north_m, start.east_m, scenario.heading_rad)
        self._windage = Windage(hull.windage, hull.length_m)
        drive = scenario.thrusters
        self._thrusters, self._rudder = Thrusters(drive), None
        if drive.rudder is not None:
            self._rudder = Rudder(drive.rudder, 0.25 * math.pi * drive.propeller.diameter_m**2)
        self._pack = Pack(scenario.battery)
        self._brownout_v, self._dark_until_s = scenario.battery.brownout_v, -math.inf
        self.movers = Movers(scenario.movers)
        self._contact = Contact(hull, self.shore, self.movers, weather.shore_hold_n)
        self.electronics = Electronics(
            scenario,
            self.shore,
            self.movers,
            self._thrusters.left,
            self._thrusters.right,
            (
                *wind_hooks(scenario.environment, self.wind),
                *tide_hooks(self._current, self._turn_tide),
            ),
            self._rudder,
        )
        self.hardware = self.electronics.hardware
        self._motors = self.electronics.motors
        self._since_tick, self._since_s, self._dt_s = 0, 0.0, math.nan
        self.truth = self._observe(0.0)
        self.electronics.sample(self.truth, self.waves)

    @property
    def time_s(self) -> float:
        """Simulated time since the start."""
        return self.truth.time_s

    @property
    def clock_s(self) -> float:
        """The clock of the boat's computer."""
        return self.truth.time_s + self.electronics.computer.clock_offset_s

    @property
    def used_mah(self) -> float:
        """Charge taken from the pack since it was full."""
        return self._pack.used_mah

    def hold_position(self) -> None:
        """Hold the boat at rest over ground; time, water, wind and sensors continue."""
        self._is_moored = True
        self._hull.hold(self._flow_n, self._flow_e)
        self.truth = self._observe(self.time_s)

    def release(self) -> None:
        """End hold_position."""
        self._is_moored = False

    def step(self, dt_s: float) -> Truth:
        """Advance by one tick; the truth at its end.

        Raises ValueError: a step too long for the hull's integrator, or not a positive time; ConfigError:
        with settings like these no boat stays on the map.
        """
        if dt_s != self._dt_s:
            if not 0.0 < dt_s <= LONGEST_STEP_S:
                raise ValueError(f"a step of {dt_s} s: expected more than 0 and at most {LONGEST_STEP_S} s")
            # Time is counted, not summed: it is tick × dt exactly for as long as dt stays the same.
            self._since_tick, self._since_s, self._dt_s = self.tick, self.time_s, dt_s
        self.tick += 1
        motors, hull, pack = self._motors, self._hull, self._pack
        north_m, east_m, heading_rad = hull.north_m, hull.east_m, hull.heading_rad
        surge_n, yaw_nm = self._thrusters.step(
            motors.left, motors.right, pack.supply_v, hull.surge_m_s, hull.yaw_rate_rad_s, dt_s
        )
        pack.step(self._thrusters.current_a, dt_s)
        sway_n = 0.0
        if self._rudder is not None and self.electronics.rudder is not None:
            ahead_n, sway_n, turning_nm = self._rudder.step(
                self.electronics.rudder.share,
                self._thrusters.left.thrust_n,
                hull.surge_m_s,
                hull.sway_m_s,
                hull.yaw_rate_rad_s,
                dt_s,
            )
            surge_n, yaw_nm = surge_n + ahead_n, yaw_nm + turning_nm
        if self._is_open:
            yaw_nm += self._flow(dt_s)
        if not self.wind.is_calm:
            self.wind.step(self.time_s)
            ahead_n, aside_n, turning_nm = self._wind_force()
            surge_n, sway_n, yaw_nm = surge_n + ahead_n, sway_n + aside_n, yaw_nm + turning_nm
        if self._is_moored:
            hull.hold(self._flow_n, self._flow_e)
        else:
            hull.step(surge_n, sway_n, yaw_nm, self._flow_n, self._flow_e, dt_s)
        if not abs(hull.north_m) + abs(hull.east_m) < _FURTHEST_M:  # NaN is no place either
            raise ConfigError(
                f"the simulated boat has left the map after {self.time_s:.1f} s: "
                "a setting of hull, thrusters or environment is out of all proportion"
            )
        time_s = self._since_s + (self.tick - self._since_tick) * dt_s
        contact = self._contact
        contact.room_m -= abs(hull.north_m - north_m) + abs(hull.east_m - east_m)
        if (contact.room_m <= 0.0 or contact.is_watchful) and contact.meets(
            hull, Pose(north_m, east_m, heading_rad), Velocity(self._flow_n, self._flow_e), dt_s, time_s
        ):
            self.groundings += not self.truth.grounded
            self._touched_s = time_s
        if pack.voltage_v < self._brownout_v or self._dark_until_s > 0.0:
            self._feed_computer(time_s)
        self.truth = truth = self._observe(time_s)
        self.electronics.sample(truth, self.waves)
        return truth

    def _feed_computer(self, time_s: float) -> None:
        """Cut the computer's power at a brown-out of the pack, and restore it afterwards."""
        computer = self.electronics.computer
        if self._pack.voltage_v < self._brownout_v:
            self._dark_until_s = time_s + POWER_UP_S
            if computer.has_power:
                computer.lose_power()
                self._motors.stop()
        elif time_s >= self._dark_until_s:
            self._dark_until_s = -math.inf
            computer.begin(time_s)

    def _turn_tide(self) -> None:
        """Apply a change of the tidal stream."""
        hull = self._hull
        self._current_n, self._current_e = self._current.at(hull.north_m, hull.east_m, self.time_s)
        if not self._is_open:
            self._flow_n, self._flow_e = self._current_n, self._current_e

    def _flow(self, dt_s: float) -> float:
        """Apply current and waves at the boat; returns their yaw moment."""
        hull, waves, time_s = self._hull, self.waves, self.time_s
        if not self._current.is_uniform:
            north_m, east_m = hull.north_m, hull.east_m
            north_m_s, east_m_s = self._current.at(north_m, east_m, time_s)
            # What it would be here, had the hull not made way through the water in the last step.
            was_north_m_s, was_east_m_s = self._current.at(
                north_m - dt_s * hull.water_north_m_s, east_m - dt_s * hull.water_east_m_s, time_s
            )
            hull.enter_current(north_m_s - was_north_m_s, east_m_s - was_east_m_s)
            self._current_n, self._current_e = north_m_s, east_m_s
        if waves.is_calm:
            self._flow_n, self._flow_e = self._current_n, self._current_e
            return 0.0
        turning = waves.yaw_rate_rad_s
        waves.step(time_s, hull.north_m, hull.east_m, hull.cos, hull.sin)
        self._flow_n, self._flow_e = self._current_n + waves.north_m_s, self._current_e + waves.east_m_s
        self._thrusters.set_immersion(waves.stern_m)
        return hull.inertia[2] * (waves.yaw_rate_rad_s - turning) / dt_s

    def _wind_force(self) -> tuple[float, float, float]:
        """Surge force, sway force and yaw moment of the air that moves past the hull."""
        truth, wind, cos, sin = self.truth, self.wind, self._hull.cos, self._hull.sin
        north_m_s, east_m_s = wind.north_m_s - truth.north_m_s, wind.east_m_s - truth.east_m_s
        return self._windage.force(north_m_s * cos + east_m_s * sin, east_m_s * cos - north_m_s * sin)

    def _observe(self, time_s: float) -> Truth:
        hull = self._hull
        return _new(
            Truth,
            (
                time_s,
                hull.north_m,
                hull.east_m,
                wrap_pi(hull.heading_rad),
                hull.surge_m_s,
                hull.sway_m_s,
                hull.yaw_rate_rad_s,
                hull.water_north_m_s + self._flow_n,
                hull.water_east_m_s + self._flow_e,
                self._thrusters.left.thrust_n,
                self._thrusters.right.thrust_n,
                time_s - self._touched_s < GROUNDED_S,
                self._current_n + self.waves.drift_north_m_s,
                self._current_e + self.waves.drift_east_m_s,
                self.wind.north_m_s,
                self.wind.east_m_s,
                self._motors.left,
                self._motors.right,
                self._pack.voltage_v,
                self._pack.current_a,
            ),
        )
