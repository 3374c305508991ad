"""Nominal state of the boat's motion: what gyro, motor commands and the hull's model let expect.

The history of the last seconds is kept without the corrections that the filter makes. The state of an
earlier moment is that of the history plus all corrections until now, so that a late measurement meets what
is known today.
"""

import math
from collections import deque
from typing import Final

from companion.config.actuators import DriveSetting, Handling
from companion.config.tuning import Estimation, Speed
from companion.control.allocation import rudder_effect
from companion.core.state import MotorCommand
from companion.core.units import wrap_pi
from companion.estimation.hull_model import SurgeModel
from companion.estimation.yaw_model import YawModel

STRIDE_S: Final = 0.039  # the hull is slow: every second tick is enough
UNMODELLED_S: Final = 3.0  # time constant of gusts and waves, that of the hull
STALL_S: Final = 1.0  # after a longer stall of the loop the motion meanwhile is unknown
_LEAST_GAIN: Final = 0.3  # below, a boat that is held aground would forget its motors
_HISTORY: Final = 128  # strides: five seconds, more than the longest delay
_GYRO_GAP_S: Final = 0.1  # five readings: a gyro that is silent for longer leaves the turn to the yaw model


class NominalState:
    """Position and speed at time_s; heading_rad and yaw_rate_rad_s at turned_s, the latest tick.

    side_m_s: sway that the model does not explain. heading_sum: all corrections of the heading. has_heading:
    there has been one. is_late: the gyro's readings are. bias_rad_s: of the gyro, or without one of the yaw
    model. driven_s: last time with thrust.
    """

    def __init__(self, speed: Speed, setting: Estimation, drive: DriveSetting, handling: Handling) -> None:
        self.cruise_m_s = speed.cruise_m_s
        self._speed, self._drive = speed, drive
        self.surge_model = SurgeModel(speed.cruise_m_s, speed.cruise_throttle, setting.surge_time_s)
        accel = handling.turn_accel_rad_s2 or handling.turn_rate_rad_s / handling.turn_time_s
        self.yaw_model = YawModel(accel, handling.turn_time_s, handling.motor_time_s)
        self.time_s = self.turned_s = self.driven_s = 0.0
        self.north_m = self.east_m = self.heading_rad = self.surge_m_s = self.side_m_s = 0.0
        self.current_north_m_s = self.current_east_m_s = 0.0
        self.bias_rad_s = self.offset_rad = self.gnss_north_m = self.gnss_east_m = self.delay_s = 0.0
        self.gain = 1.0
        self.has_heading = self.has_gyro = self.is_late = False
        self.gyro_bias_rad_s = 0.0  # as it was when there was a gyro last
        self._rate_rad_s = self._gyro_rad_s = 0.0  # of the heading at the last tick; raw, latest
        self._gyro_s = -math.inf
        self._north_sum = self._east_sum = self.heading_sum = self._surge_sum = self._side_sum = 0.0
        self._history = deque([(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)], maxlen=_HISTORY)

    @property
    def sway_m_s(self) -> float:
        """Sway through the water: the hull's model and what it does not explain."""
        return self.surge_model.sway_m_s + self.side_m_s

    def through_water(self, heading_rad: float) -> complex:
        """Velocity through the water, north + i east."""
        cos, sin = math.cos(heading_rad), math.sin(heading_rad)
        surge, sway = self.surge_m_s, self.surge_model.sway_m_s + self.side_m_s
        return complex(surge * cos - sway * sin, surge * sin + sway * cos)

    @property
    def current_m_s(self) -> complex:
        """The current, north + i east."""
        return complex(self.current_north_m_s, self.current_east_m_s)

    @property
    def measured_rate_rad_s(self) -> float | None:
        """The gyro's latest rate less its bias; None without a gyro."""
        return self._rate_rad_s if self.has_gyro else None

    def turn(self, now_s: float, gyro_rad_s: float | None, *, learns: bool = True) -> None:
        """Advance heading and yaw rate to now_s. gyro_rad_s: a new reading of it, if any. learns: whether the
        reading says what turn steering gives; late ones teach a gain that explains their delay.
        """
        dt, yaw = now_s - self.turned_s, self.yaw_model
        self.turned_s = now_s
        if gyro_rad_s is not None:
            if not self.has_gyro:
                self.use_gyro(has_gyro=True)
            self._gyro_s, self._gyro_rad_s = now_s, gyro_rad_s
            yaw.update(gyro_rad_s - self.bias_rad_s, learns=learns)
        elif self.has_gyro and now_s - self._gyro_s > _GYRO_GAP_S:
            self.use_gyro(has_gyro=False)
        rate = (self._gyro_rad_s if self.has_gyro else yaw.rate_rad_s) - self.bias_rad_s
        turned = 0.5 * (rate + self._rate_rad_s) * (dt if dt < _GYRO_GAP_S else _GYRO_GAP_S)
        self._rate_rad_s = rate
        self.heading_rad = wrap_pi(self.heading_rad + turned)

    def turn_late(self, time_s: float, dt_s: float, gyro_rad_s: float) -> None:
        """Replace the modelled turn over dt_s until time_s by that of a gyro that is late."""
        modelled = self.at(time_s)[2] - self.at(time_s - dt_s)[2]
        self._turn_by((gyro_rad_s - self.gyro_bias_rad_s) * dt_s - modelled)

    def use_gyro(self, *, has_gyro: bool) -> None:
        """Begin or cease to turn by the gyro: the bias is that of another source then."""
        if has_gyro:
            self.bias_rad_s = self.gyro_bias_rad_s
        else:
            self.gyro_bias_rad_s, self.bias_rad_s = self.bias_rad_s, 0.0
        self.has_gyro = has_gyro

    @property
    def yaw_rate_rad_s(self) -> float:
        """The present yaw rate."""
        yaw = self.yaw_model
        return yaw.rate_rad_s + yaw.wave_rad_s if self.has_gyro else yaw.rate_rad_s - self.bias_rad_s

    def move(self, now_s: float, command: MotorCommand | None) -> None:
        """Advance position and speed to now_s."""
        dt, surge = min(now_s - self.time_s, STALL_S), self.surge_model
        heading, before = self.heading_rad, self.surge_m_s
        left = right = rudder = 0.0
        if command is not None and self.has_heading:  # without a heading, thrust has no direction
            left, right, rudder = command.left, command.right, command.rudder
            if left or right:
                self.driven_s = now_s
            if rudder:
                rudder *= rudder_effect(0.5 * (left + right), before, self._drive, self._speed)
        self.yaw_model.advance(left, right, rudder, dt)
        self.surge_m_s = surge.advance(before, self.yaw_rate_rad_s, left, right, self.gain, dt)
        self.side_m_s -= self.side_m_s * dt / UNMODELLED_S
        moved = self.through_water(heading)
        self.north_m += (moved.real + self.current_north_m_s) * dt
        self.east_m += (moved.imag + self.current_east_m_s) * dt
        self.time_s = now_s
        self._history.append((
            now_s, self.north_m - self._north_sum, self.east_m - self._east_sum, heading - self.heading_sum,
            self.surge_m_s - self._surge_sum, surge.sway_m_s + self.side_m_s - self._side_sum,
        ))  # fmt: skip

    def at(self, time_s: float) -> tuple[float, float, float, complex]:
        """Position, heading and velocity over ground at an earlier time, by what is known now."""
        entry = self._history[0]
        for entry in reversed(self._history):
            if entry[0] <= time_s:
                break
        then_s, north, east, heading, surge, sway = entry
        heading += self.heading_sum
        cos, sin = math.cos(heading), math.sin(heading)
        surge += self._surge_sum
        sway += self._side_sum
        north_m_s = surge * cos - sway * sin + self.current_north_m_s
        east_m_s = surge * sin + sway * cos + self.current_east_m_s
        later = min(max(time_s - then_s, 0.0), STALL_S)
        return (
            north + self._north_sum + north_m_s * later,
            east + self._east_sum + east_m_s * later,
            heading,
            complex(north_m_s, east_m_s),
        )

    def _turn_by(self, step_rad: float) -> None:
        self.heading_rad = wrap_pi(self.heading_rad + step_rad)
        self.heading_sum += step_rad

    def _place(self, north_m: float, east_m: float) -> None:
        self.north_m += north_m
        self._north_sum += north_m
        self.east_m += east_m
        self._east_sum += east_m

    def _correct(self, step: list[float]) -> None:
        """Add a correction, in the order of `covariance.py`."""
        north, east, turn, surge, side, set_north, set_east, bias, offset, gain, wander_n, wander_e, delay = (
            step
        )
        self._place(north, east)
        self._turn_by(turn)
        self.surge_m_s += surge
        self._surge_sum += surge
        self.side_m_s += side
        self._side_sum += side
        self.current_north_m_s += set_north
        self.current_east_m_s += set_east
        self.bias_rad_s += bias
        self.offset_rad += offset
        self.gain = max(self.gain + gain, _LEAST_GAIN)
        self.gnss_north_m += wander_n
        self.gnss_east_m += wander_e
        self.delay_s += delay
