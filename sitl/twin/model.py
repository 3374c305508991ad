"""The emulator's hull, windage and drive for many boats at once: the arithmetic of `sitl.world.hull`,
`windage`, `drive.thruster` and `pack` on arrays, step for step the same.

Axes: boats that differ in their parameters, then segments of voyages. The heading is an input, so that no
error of it grows; the current carries boat and frame alike and is added by the caller.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Final, NamedTuple

import numpy as np

from sitl.twin.voyage import STORED_S, Floats
from sitl.world.drive.propeller import WATER_KG_M3
from sitl.world.scenario import Scenario
from sitl.world.windage import AIR_KG_M3

DISTURBANCES: Final = (0.01, 0.02, 0.05)
"""Deviations of what gusts accelerate a small boat by, in sway (m/s²) and yaw (rad/s²), and of its turn rate
as measured (rad/s), with which a fit begins. Waves turn it by so much; a gyro's noise is a twentieth of it.
"""
_GUST_S: Final = 4.0  # their correlation time: `sitl.world.environment.settings`
_BEGUN: Final = (0.05, 0.01)  # deviations of sway and turn rate at the beginning, m/s and rad/s
_STEP: Final = 1e-4  # of sway and turn rate, for differences
LEFT, RIGHT = "thrusters.left_gain", "thrusters.right_gain"


class Manoeuvre(NamedTuple):
    """What tells a parameter: words for a person."""

    meaning: str
    told_by: str


_STRAIGHTS = "straight legs at three speeds, full throttle among them"
_STOPS = "stops and starts"
_ZIGZAG = "a zigzag at speed"
_WINDY = "stops and slow legs on a windy day"
_SPOT = "turns on the spot and slow zigzags"
KEYS: Final[Mapping[str, Manoeuvre]] = {
    "hull.surge_linear": Manoeuvre("drag ahead, N per m/s", "stops that coast, and slow straight legs"),
    "hull.surge_quadratic": Manoeuvre("drag ahead, N per (m/s)²", _STRAIGHTS),
    "hull.sway_added_kg": Manoeuvre("added mass sideways", _ZIGZAG),
    "hull.sway_linear": Manoeuvre("drag sideways, N per m/s", "slow circles"),
    "hull.sway_quadratic": Manoeuvre("drag sideways, N per (m/s)²", "tight circles at speed"),
    "hull.crossflow_length_m": Manoeuvre("length of the deep part: damping of fast turns", _SPOT),
    "hull.inertia_kg_m2": Manoeuvre("inertia in yaw", _ZIGZAG),
    "hull.yaw_linear": Manoeuvre("damping in yaw, N m per rad/s", _SPOT),
    "hull.skeg_lift_kg_m": Manoeuvre("lift of the skeg", "circles at speed"),
    "hull.skeg_arm_m": Manoeuvre("its arm abaft the centre", "circles and a zigzag at speed"),
    "hull.windage.frontal_drag": Manoeuvre("the wind's force ahead", _WINDY),
    "hull.windage.lateral_drag": Manoeuvre("the wind's force sideways", _WINDY),
    "hull.windage.turning": Manoeuvre("the wind's moment", _WINDY),
    "thrusters.propeller.thrust_coefficient": Manoeuvre("thrust, for the mass stated", _STRAIGHTS),
    "thrusters.propeller.zero_thrust_advance": Manoeuvre("loss of thrust with speed", _STRAIGHTS),
    "thrusters.propeller.torque_coefficient": Manoeuvre("thrust's growth with the command", _STRAIGHTS),
    "thrusters.propeller.zero_torque_advance": Manoeuvre("loss of torque with speed", _STRAIGHTS),
    "thrusters.propeller.astern_share": Manoeuvre("thrust astern, of that ahead", "full astern from speed"),
    "thrusters.motor.inertia_kg_m2": Manoeuvre("the motors' lag", _ZIGZAG),
    "thrusters.motor.resistance_ohm": Manoeuvre("winding: current drawn", "a monitor of the current"),
    "thrusters.motor.no_load_a": Manoeuvre("friction: the dead band", _SPOT),
    "thrusters.esc.dead_band": Manoeuvre("dead band of the controllers", _SPOT),
    LEFT: Manoeuvre("what the left motor makes of a command", "straight legs"),
    RIGHT: Manoeuvre("what the right motor makes of a command", "straight legs"),
}
"""What is fitted, by the boat file's key, and which manoeuvre tells it."""


@dataclass(frozen=True, slots=True)
class SegmentInputs:
    """Inputs per step and segment, shape (steps, segments): commands, open-circuit voltage (V), heading
    (rad). pack_ohm by segment. With a measured turn rate (rad/s) the model's is the one that a filter
    predicts from it: so a hull that does not keep its course by itself can be simulated, too.
    """

    step_s: float
    left: Floats
    right: Floats
    open_v: Floats
    heading_rad: Floats
    pack_ohm: Floats
    rate_rad_s: Floats | None = None


Value = Callable[[str], Floats]


class _Drive:
    """As `Propeller`, `Thruster` and `Pack`; the first axis of what the shafts have is left and right."""

    def __init__(self, base: Scenario, value: Value, inputs: SegmentInputs, shape: tuple[int, ...]) -> None:
        drive, screw = base.thrusters, base.thrusters.propeller
        self._inputs, self._idle_a, self._arm_m = inputs, base.battery.idle_a, 0.5 * drive.apart_m
        area, turn = WATER_KG_M3 * screw.diameter_m**3, 0.5 / np.pi
        thrust = area * turn * value("thrusters.propeller.thrust_coefficient")
        torque = area * turn * screw.diameter_m * value("thrusters.propeller.torque_coefficient")
        self._t_nn = thrust * turn * screw.diameter_m
        self._t_nu = thrust / value("thrusters.propeller.zero_thrust_advance")
        self._a_nn = self._t_nn * value("thrusters.propeller.astern_share")
        self._q_nn = torque * turn * screw.diameter_m + drive.motor.churning
        self._q_nu = torque / value("thrusters.propeller.zero_torque_advance")
        self._emf, self._rotor = drive.motor.back_emf_v_s, value("thrusters.motor.inertia_kg_m2")
        self._friction = self._emf * value("thrusters.motor.no_load_a")
        esc, bridge = drive.esc, drive.bridge
        leads_ohm = bridge.resistance_ohm if esc is None else esc.resistance_ohm
        self._conductance = 1.0 / (value("thrusters.motor.resistance_ohm") + leads_ohm)
        self._drop_v, self._brakes = (bridge.drop_v, bridge.brake) if esc is None else (0.0, True)
        dead = 0.0 if esc is None else value("thrusters.esc.dead_band")
        gains = np.stack(np.broadcast_arrays(value(LEFT), value(RIGHT))).reshape(2, -1, 1)
        commands = np.stack([inputs.left, inputs.right], axis=1)[:, :, None] * gains
        self._share = np.maximum(np.abs(commands) - dead, 0.0) / (1.0 - dead)
        self._side, self._closed = np.where(commands < 0.0, -1.0, 1.0), (self._share > 0.0) | (dead == 0.0)
        self._speed, self.drawn_a = np.zeros((2, *shape)), np.zeros(shape)
        self._volts = self._supply = np.broadcast_to(inputs.open_v[0] - inputs.pack_ohm * self._idle_a, shape)

    def step(self, step: int, u: Floats, r: Floats) -> tuple[Floats, Floats]:
        """Force ahead and clockwise moment."""
        dt, side, share, emf = self._inputs.step_s, self._side[step], self._share[step], self._emf
        advance = np.stack([u + self._arm_m * r, u - self._arm_m * r])
        speed, water = side * self._speed, side * advance
        if self._brakes:
            over = share * self._supply - emf * speed
            over = np.sign(over) * np.maximum(np.abs(over) - self._drop_v, 0.0)
            leads = self._conductance * ((over != 0.0) & self._closed[step])
        else:
            over = np.maximum(self._supply - self._drop_v - emf * speed, 0.0)
            leads = self._conductance * share * (over > 0.0)
        amps, size = over * leads, np.abs(speed)
        way = np.where(speed >= 0.0, self._q_nu, -self._q_nu) * water
        slope = np.maximum(emf * emf * leads + 2.0 * self._q_nn * size - way, 0.0)
        lag = dt / (self._rotor + dt * slope)
        speed = speed + lag * (emf * amps - (self._q_nn * speed - self._q_nu * water) * size)
        speed = side * np.sign(speed) * np.maximum(np.abs(speed) - self._friction * lag, 0.0)
        size = np.abs(speed)
        pull = (np.where(speed >= 0.0, self._t_nn, self._a_nn) * speed - self._t_nu * advance) * size
        self._speed, self.drawn_a = speed, (share * np.maximum(amps, 0.0)).sum(axis=0)
        volts = self._inputs.open_v[step] - self._inputs.pack_ohm * (self.drawn_a + self._idle_a)
        self._supply, self._volts = 0.5 * (self._volts + volts), volts
        return pull[0] + pull[1], (pull[0] - pull[1]) * self._arm_m


class _Hull:
    """As `Hull` and `Windage`."""

    def __init__(self, base: Scenario, value: Value, shape: tuple[int, ...]) -> None:
        hull, air, rho = base.hull, base.hull.windage, 0.5 * AIR_KG_M3
        self._m11 = hull.mass_kg + hull.surge_added_kg
        self._m22 = hull.mass_kg + value("hull.sway_added_kg")
        self._m33 = value("hull.inertia_kg_m2") + hull.yaw_added_kg_m2
        self._xu, self._xuu = value("hull.surge_linear"), value("hull.surge_quadratic")
        self._yv, self._yvv = value("hull.sway_linear"), value("hull.sway_quadratic")
        self._nr, self._nrr = value("hull.yaw_linear"), hull.yaw_quadratic
        self._half, self._skeg = 0.5 * value("hull.crossflow_length_m"), value("hull.skeg_lift_kg_m")
        self._arm, self._lever_m = value("hull.skeg_arm_m"), air.lever_m
        self._air_x = rho * value("hull.windage.frontal_drag") * air.frontal_area_m2
        self._air_y = rho * value("hull.windage.lateral_drag") * air.lateral_area_m2
        self._air_n = 2.0 * rho * value("hull.windage.turning") * air.lateral_area_m2 * hull.length_m
        self.u, self.v, self.r = (np.zeros(shape) for _ in range(3))
        self.gusts = np.zeros((2, *shape))
        self._bends: tuple[Floats, ...] = ()

    def wind(self, north: Floats, east: Floats, heading_rad: Floats) -> tuple[Floats, Floats, Floats]:
        """Forces ahead and to starboard and the moment of a wind relative to the water."""
        cos, sin = np.cos(heading_rad), np.sin(heading_rad)
        ahead, aside = north * cos + east * sin - self.u, east * cos - north * sin - self.v
        speed = np.sqrt(ahead * ahead + aside * aside)
        sway_n = self._air_y * speed * aside
        return self._air_x * speed * ahead, sway_n, self._lever_m * sway_n - self._air_n * ahead * aside

    def rates(self, u: Floats, v: Floats, r: Floats) -> tuple[Floats, Floats, Floats]:
        """Accelerations that depend on the velocity."""
        yvv, half, m11, m22 = self._yvv, self._half, self._m11, self._m22
        sideways, tip = np.abs(v), half * np.abs(r)
        square = np.minimum(sideways / np.maximum(tip, 1e-12), 1.0) ** 2
        is_drift = sideways >= tip
        along = sideways + tip * tip / (3.0 * np.maximum(sideways, 1e-12))
        drag_n = yvv * v * np.where(is_drift, along, tip * (1.0 + square / 3.0))
        turning = tip * (0.25 + 0.5 * square - square * square / 12.0)
        drag_nm = yvv * half * half * r * np.where(is_drift, sideways / 1.5, turning)
        lift = self._skeg * np.abs(u) * (v - self._arm * r)
        return (
            (m22 * v * r - (self._xu + self._xuu * np.abs(u)) * u) / m11,
            (-m11 * u * r - self._yv * v - drag_n - lift) / m22,
            ((m11 - m22) * u * v - (self._nr + self._nrr * np.abs(r)) * r - drag_nm + self._arm * lift)
            / self._m33,
        )

    def step(self, surge_n: Floats, sway_n: Floats, yaw_nm: Floats, dt: float) -> None:
        rates = self.rates(self.u, self.v, self.r)
        du, dv, dr = (1.5 * a - 0.5 * b for a, b in zip(rates, self._bends or rates, strict=True))
        self._bends = rates
        self.u = self.u + dt * (du + surge_n / self._m11)
        self.v = self.v + dt * (dv + sway_n / self._m22 + self.gusts[0])
        self.r = self.r + dt * (dr + yaw_nm / self._m33 + self.gusts[1])


class _GustFilter:
    """An extended Kalman filter of sway, turn rate and what gusts accelerate both by, first-order
    Gauss-Markov processes, corrected by the measured turn rate every STORED_S.

    A boat's program steers against gusts. Without them in the model, commands correlate with what it misses,
    and the fit is biased (L. Ljung, *System Identification*, 2nd edition, 1999, sections 13.4 and 13.5).
    """

    def __init__(self, deviations: Floats, shape: tuple[int, ...]) -> None:
        *gusts, rate = deviations
        self._noise = rate[..., None] ** 2
        begun = np.broadcast_arrays(*(one * np.ones(shape) for one in (*_BEGUN, *gusts)))
        self._known = np.stack(begun, axis=-1)[..., None] ** 2 * np.eye(4)
        keep = math.exp(-STORED_S / _GUST_S)
        self._keep, self._fresh = keep, (1.0 - keep * keep) * self._known * np.diag([0.0, 0.0, 1.0, 1.0])

    def correct(self, hull: _Hull, rate_rad_s: Floats) -> None:
        u, v, r = hull.u, hull.v, hull.r
        gain = self._known[..., 1] / (self._known[..., 1, 1, None] + self._noise)
        self._known = self._known - gain[..., None] * self._known[..., 1, None, :]
        slopes = np.zeros(self._known.shape)
        still = hull.rates(u, v, r)[1:]
        for n, moved in enumerate((hull.rates(u, v + _STEP, r), hull.rates(u, v, r + _STEP))):
            for m, (one, other) in enumerate(zip(moved[1:], still, strict=True)):
                slopes[..., m, n] = STORED_S / _STEP * (one - other)
        slopes[..., 0, 2] = slopes[..., 1, 3] = STORED_S
        slopes[..., 2, 2] = slopes[..., 3, 3] = math.log(self._keep)
        moves = np.eye(4) + slopes + 0.5 * slopes @ slopes
        self._known = moves @ self._known @ moves.swapaxes(-1, -2) + self._fresh
        off = rate_rad_s - r
        hull.v, hull.r = v + gain[..., 0] * off, r + gain[..., 1] * off
        hull.gusts = self._keep * (hull.gusts + np.moveaxis(gain[..., 2:], -1, 0) * off)


@np.errstate(over="ignore", invalid="ignore")  # a step of the fit may try a hull that no filter holds
def simulate(
    base: Scenario,
    factors: Mapping[str, Floats],
    inputs: SegmentInputs,
    surge_m_s: Floats,
    wind_north_m_s: Floats,
    wind_east_m_s: Floats,
    disturbances: Floats | None = None,
) -> Floats:
    """Surge and sway (m/s, through the water), turn rate (rad/s) and the motors' current (A), before each
    step, shape (steps, 4, boats, segments).

    factors: on the base boat's values, by key, shape (boats, 1). surge_m_s: at the beginning; wind: relative
    to the water. Both are broadcast to (boats, segments). disturbances: as DISTURBANCES, shape (3, boats, 1),
    where the turn rate was measured.
    """

    def value(path: str) -> Floats:
        return np.asarray(attrgetter(path)(base) * factors.get(path, 1.0), dtype=np.float64)

    boats = [np.shape(one) for one in factors.values()]
    shape = np.broadcast_shapes((1, 1), np.shape(surge_m_s), inputs.left.shape[1:], *boats)
    hull, drive = _Hull(base, value, shape), _Drive(base, value, inputs, shape)
    hull.u = np.broadcast_to(surge_m_s, shape).copy()
    every, steps, measured = round(STORED_S / inputs.step_s), len(inputs.left), inputs.rate_rad_s
    if measured is not None:
        hull.r = np.broadcast_to(measured[0], shape)
        filtered = _GustFilter(
            np.reshape(DISTURBANCES, (3, 1, 1)) if disturbances is None else disturbances, shape
        )
    out = np.empty((steps, 4, *shape))
    for step in range(steps):
        out[step] = hull.u, hull.v, hull.r, drive.drawn_a
        if measured is not None and step % every == 0:
            filtered.correct(hull, measured[step])
        surge_n, yaw_nm = drive.step(step, hull.u, hull.r)
        ahead_n, sway_n, turning_nm = hull.wind(wind_north_m_s, wind_east_m_s, inputs.heading_rad[step])
        hull.step(surge_n + ahead_n, sway_n, yaw_nm + turning_nm, inputs.step_s)
    return out
