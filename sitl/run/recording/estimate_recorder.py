"""The boat's estimates, demands and commands during a run, for reports."""

import math
from array import array
from typing import NamedTuple

import numpy as np

from companion.boat import Boat
from companion.core.geo import LatLon, LocalFrame, Point
from companion.estimation.estimator import Estimator

EVERY_S = 0.1
MOST_ECHOES = 100_000
_NAN = math.nan


class Estimate(NamedTuple):
    """The estimate, the demand and the command of one tick; NaN where there is none.

    north_m, east_m: in the scenario's frame; the boat's own frame starts where it boots.
    current_*: the estimated drift by current and wind. faults: bits of EstimateFault. left, right: the
    motor commands, −1..1. mode: Rover's number. *_nu: the filter's latest innovation of a sensor in standard
    deviations, rejected_*: whether its gate rejected it. wrong_*: probability that a sensor is wrong.
    """

    time_s: float
    north_m: float = _NAN
    east_m: float = _NAN
    heading_rad: float = _NAN
    surge_m_s: float = _NAN
    current_north_m_s: float = _NAN
    current_east_m_s: float = _NAN
    position_sigma_m: float = _NAN
    faults: float = 0.0
    demand_heading_rad: float = _NAN
    demand_speed_m_s: float = _NAN
    left: float = 0.0
    right: float = 0.0
    mode: float = _NAN
    armed: float = 0.0
    position_north_nu: float = _NAN
    position_east_nu: float = _NAN
    velocity_north_nu: float = _NAN
    velocity_east_nu: float = _NAN
    compass_nu: float = _NAN
    rejected_position: float = 0.0
    rejected_velocity: float = 0.0
    rejected_compass: float = 0.0
    wrong_compass: float = _NAN
    wrong_gyro: float = _NAN
    wrong_gnss: float = _NAN


_FIELDS = len(Estimate._fields)

Rows = np.ndarray[tuple[int, int], np.dtype[np.float64]]


class EstimateRecorder:
    """One row a tenth of a second, and every sonar echo at its estimated position."""

    def __init__(self, frame: LocalFrame) -> None:
        """Start empty. frame: the scenario's, in which everything is kept."""
        self._frame = frame
        self._origin: LatLon | None = None  # of the boat's own frame, and where that lies in the scenario's
        self._shift = Point(0.0, 0.0)
        self._numbers = array("d")
        self._echoes = array("d")
        self._next_s = 0.0
        self._ping_s = -math.inf

    def tick(self, boat: Boat, now_s: float) -> None:
        """Call after each step of the boat."""
        own = boat.estimator.frame
        if own is not None and own.origin is not self._origin:
            self._origin, self._shift = own.origin, self._frame.to_local(own.origin)
        sonar = boat.sensors.sonar
        if sonar is not None and sonar.time_s != self._ping_s:
            self._ping_s = sonar.time_s
            nav = boat.nav
            if nav is not None and sonar.range_m is not None and len(self._echoes) < 3 * MOST_ECHOES:
                bearing = nav.heading_rad + sonar.bearing_rad
                north_m = self._shift.north_m + nav.north_m + sonar.range_m * math.cos(bearing)
                east_m = self._shift.east_m + nav.east_m + sonar.range_m * math.sin(bearing)
                self._echoes.extend((now_s, north_m, east_m))
        if now_s + 1e-9 >= self._next_s:
            self._next_s = now_s + EVERY_S
            self._numbers.extend(_estimate(boat, self._shift, now_s))

    @property
    def rows(self) -> Rows:
        """A copy, shape (rows, fields of Estimate)."""
        return np.array(self._numbers, dtype=np.float64).reshape(-1, _FIELDS)

    @property
    def echoes(self) -> Rows:
        """A copy, shape (echoes, 3): time, and estimated north and east."""
        return np.array(self._echoes, dtype=np.float64).reshape(-1, 3)


def _estimate(boat: Boat, shift: Point, now_s: float) -> Estimate:
    nav, demand, command, vehicle = boat.nav, boat.guidance.demand, boat.command, boat.vehicle
    return Estimate(
        now_s,
        *(
            (_NAN,) * 7 + (0.0,)
            if nav is None
            else (
                shift.north_m + nav.north_m,
                shift.east_m + nav.east_m,
                nav.heading_rad,
                nav.surge_m_s,
                nav.current_north_m_s,
                nav.current_east_m_s,
                nav.position_sigma_m,
                float(nav.faults),
            )
        ),
        *((_NAN, _NAN) if demand is None else (demand.heading_rad, demand.speed_m_s)),
        command.left,
        command.right,
        float(vehicle.mode),
        float(vehicle.armed),
        *_inside(boat.estimator),
    )


def _inside(estimator: Estimator) -> tuple[float, ...]:
    """Innovations, rejections and probabilities; nothing before the first fix."""
    if estimator.frame is None:
        return ()
    position, velocity, compass = estimator.state.position, estimator.state.velocity, estimator.state.compass
    return (
        *[
            one.value / math.sqrt(one.variance) if one.time_s >= 0.0 else _NAN
            for one in (position.north, position.east, velocity.north, velocity.east, compass)
        ],
        *[
            float(one.time_s >= 0.0 and not one.is_accepted)
            for one in (position.north, velocity.north, compass)
        ],
        *estimator.heading.bank.probabilities(),
    )
