"""Track of one obstacle, and whether it moves.

A range is accurate along the beam and poor across it. The filter has constant velocity with white
acceleration (Bar-Shalom, Li, Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001,
section 6.3.2), jointly in north and east, and each observation is two scalar measurements, along and across
the beam.

The paper's terms: dR0 (its equation 1) is `Track.distance_m`; an obstacle is static or dynamic (`is_mover`),
and a dynamic one approaches or recedes (`closing_m_s`). The nearest point of a large obstacle slides along it
as the boat passes, across the beam. So a mover is declared only if it is isolated in free water and
approaches along the beam, at three standard deviations. What may move is avoided long before
(`planning/movers.py`).
"""

import math
from collections.abc import Sequence
from typing import Final

from companion.core.geo import Point, distance_m
from companion.obstacles.perception.occupancy import MAX_EVIDENCE, SWEEP_S

# Isolated observations before a track is called a mover. A false echo (one in 200 pings) has another one in
# its gate, 0.6 m of 4 m in five pings, once in 130, and a quarter of these pairs approach: 14 in 24 h. A
# third one makes a likelihood ratio of 130² for a thing.
_CONFIRMED: Final = 3
SURE_SIGMAS: Final = 3.0  # 1 in 700 of static obstacles, one-sided
FASTEST: Final = 12.0  # of the least speed: 1.4 m/s; faster tracks join two ghosts
_SPREAD: Final = (100.0, 100.0, 0.25, 0.25)  # initial variances: anywhere in sight, 0.5 m/s


class Track:
    """Position and velocity over ground in the local frame; `number` is unique."""

    def __init__(self, number: int, seen_s: float, at: Point, radius_m: float) -> None:
        """Start at rest with full uncertainty; the first observation is added by `correct`."""
        self.number = number
        self.created_s = self.seen_s = self._time_s = seen_s
        self.radius_m = radius_m
        self.observations = 1
        self.isolated_count = 0  # observations with free water on either side,
        self.whole_count = 0  # of those that covered both edges
        self.evidence = 1.0  # as of a cell in the grid
        self.is_mover = False
        self._left = at
        self._stood_at: Point | None = None
        self._beam_n = self._beam_e = 0.0
        self._state = [at.north_m, at.east_m, 0.0, 0.0]
        self._covariance = [[_SPREAD[i] if i == j else 0.0 for j in range(4)] for i in range(4)]

    @property
    def north_m_s(self) -> float:
        """Velocity over ground."""
        return self._state[2]

    @property
    def east_m_s(self) -> float:
        """Velocity over ground."""
        return self._state[3]

    @property
    def speed_m_s(self) -> float:
        """Speed over ground."""
        return math.hypot(self._state[2], self._state[3])

    @property
    def speed_sigma_m_s(self) -> float:
        """Standard deviation of the speed, along the velocity."""
        speed = self.speed_m_s
        if speed < 1e-6:
            return math.sqrt(max(self._covariance[2][2], self._covariance[3][3]))
        return self.pace_sigma_m_s(self._state[2] / speed, self._state[3] / speed)

    def pace_sigma_m_s(self, north: float, east: float) -> float:
        """Standard deviation of the velocity along a direction."""
        p = self._covariance
        variance = north * north * p[2][2] + 2.0 * north * east * p[2][3] + east * east * p[3][3]
        return math.sqrt(max(variance, 0.0))

    def covariance(self, time_s: float) -> tuple[float, float, float]:
        """Of its position at a time: north, north and east, east."""
        p, ahead_s = self._covariance, max(time_s - self._time_s, 0.0)
        nn, ne, ee = (
            p[i][j] + ahead_s * (p[i][j + 2] + p[i + 2][j] + ahead_s * p[i + 2][j + 2])
            for i, j in ((0, 0), (0, 1), (1, 1))
        )
        return nn, ne, ee

    def rest_ratio(self) -> float:
        """Density of its velocity at rest, of what it was before the first observation."""
        (_, _, v_n, v_e), p = self._state, self._covariance
        nn, ne, ee = p[2][2], p[2][3], p[3][3]
        size = max(nn * ee - ne * ne, 1e-9)
        away = (ee * v_n * v_n - 2.0 * ne * v_n * v_e + nn * v_e * v_e) / size
        return math.sqrt(_SPREAD[2] * _SPREAD[3] / size) * math.exp(-0.5 * away)

    def point(self, now_s: float) -> Point:
        """Position at a time; without known motion, the last one."""
        ahead_s, state = now_s - self._time_s if self.is_mover else 0.0, self._state
        return Point(state[0] + state[2] * ahead_s, state[1] + state[3] * ahead_s)

    def distance_m(self, boat: Point, now_s: float) -> float:
        """The paper's dR0."""
        at = self.point(now_s)
        return math.hypot(at.north_m - boat.north_m, at.east_m - boat.east_m)

    def closing_m_s(self, boat: Point, north_m_s: float, east_m_s: float, now_s: float) -> float:
        """Rate at which dR0 shrinks for a boat of this velocity: positive approaches, negative recedes."""
        at = self.point(now_s)
        north, east = at.north_m - boat.north_m, at.east_m - boat.east_m
        distance = max(math.hypot(north, east), 1e-6)
        return ((north_m_s - self._state[2]) * north + (east_m_s - self._state[3]) * east) / distance

    def may_move(self, now_s: float) -> bool:
        """Whether it was seen lately and does not belong to something longer, as far as was observed."""
        is_new = now_s - self.created_s < SWEEP_S
        is_isolated = 2 * self.isolated_count >= self.whole_count if self.whole_count else is_new
        return self.is_mover or (now_s - self.seen_s < SWEEP_S and is_isolated)

    def take_way(self, now_s: float) -> tuple[Point, Point]:
        """Where it has been since the last call, at first since it was first seen."""
        start, self._left = self._left, self.point(now_s)
        return start, self._left

    def note_standing(self, at: Point, standing: Sequence[Point]) -> None:
        """The track's place, and those of what stands still: it is of that if it touches it."""
        if any(distance_m(at, one) < self.radius_m for one in standing):
            self._stood_at = at

    def stands(self, now_s: float, reach_m: float) -> bool:
        """Whether it is within reach_m of where it was part of something still."""
        return self._stood_at is not None and distance_m(self._stood_at, self.point(now_s)) < reach_m

    # Called by ObstacleTracks

    def predict(self, now_s: float, accel_m_s2: float) -> None:
        """Advance the state."""
        dt = now_s - self._time_s
        if dt <= 0.0:
            return
        x, p = self._state, self._covariance
        q = (accel_m_s2 * dt) ** 2
        for axis in (0, 1):
            x[axis] += dt * x[axis + 2]
            for j in range(4):
                p[axis][j] += dt * p[axis + 2][j]
        for axis in (0, 1):
            for i in range(4):
                p[i][axis] += dt * p[i][axis + 2]
        for axis in (0, 1):
            p[axis][axis] += 0.25 * q * dt * dt
            p[axis][axis + 2] += 0.5 * q * dt
            p[axis + 2][axis] += 0.5 * q * dt
            p[axis + 2][axis + 2] += q
        self._time_s = now_s

    def deviation_sigmas(self, at: Point, north: float, east: float, sigma_m: float) -> float:
        """Deviation of a place from the prediction along a direction, in standard deviations."""
        p = self._covariance
        variance = north * north * p[0][0] + 2.0 * north * east * p[0][1] + east * east * p[1][1]
        off = (at.north_m - self._state[0]) * north + (at.east_m - self._state[1]) * east
        return abs(off) / math.sqrt(variance + sigma_m * sigma_m)

    def correct(self, at: Point, north: float, east: float, sigma_m: float) -> None:
        """Update with a place, along one direction."""
        x, p = self._state, self._covariance
        cross = [row[0] * north + row[1] * east for row in p]
        variance = cross[0] * north + cross[1] * east + sigma_m * sigma_m
        off = (at.north_m - x[0]) * north + (at.east_m - x[1]) * east
        for i in range(4):
            gain = cross[i] / variance
            x[i] += gain * off
            for j in range(4):
                p[i][j] -= gain * cross[j]

    def complete_observation(
        self, radius_m: float, beam_n: float, beam_e: float, *, is_alone: bool = True
    ) -> None:
        """Finish an observation; the beam's direction points from the boat. is_alone: the neighbouring beams
        saw free water.
        """
        self.observations += 1
        self.evidence = min(self.evidence + 1.0, MAX_EVIDENCE)
        self.isolated_count += is_alone
        self.seen_s = self._time_s
        self.radius_m = max(radius_m, 0.8 * self.radius_m)
        self._beam_n, self._beam_e = beam_n, beam_e

    def classify(self, least_m_s: float) -> None:
        """Decide whether it moves: it approaches the boat over ground, and goes on doing so."""
        if self.is_mover:
            self.is_mover = self.speed_m_s > max(self.speed_sigma_m_s, 0.5 * least_m_s)
        elif self.isolated_count >= _CONFIRMED and self.speed_m_s < FASTEST * least_m_s:
            north, east = self._beam_n, self._beam_e
            towards = -(self._state[2] * north + self._state[3] * east)
            self.is_mover = towards > max(SURE_SIGMAS * self.pace_sigma_m_s(north, east), least_m_s)
