"""Contact of the hull with the shore, an obstacle or a mover: it scrapes, stops or grounds.

The hull is a pentagon: bow, both sides amidships, both corners of the transom. It touches where one of its
sides crosses a stretch of shore or comes into a mover's circle. A touch is an inelastic impact at the
point of contact: the impulse along the normal takes the speed into the shore, friction takes at most its
coefficient times as much of the speed along it (Coulomb), both through the hull's own inertia, so that a
impact at the bow turns it. No impact adds energy over ground. The hull's outline stays on the water.

A soft shore holds a grounded hull until thrust, wind and current together exceed hold_n.
"""

import math
from typing import NamedTuple

from sitl.world.hull import Hull
from sitl.world.hull_settings import HullSettings
from sitl.world.movers import Movers
from sitl.world.shore import Shore

FRICTION = 0.3  # plastic on wet stone or wood
_ATTEMPTS = 3  # to find a pose beside the shore: in a corner one impact leads to the next
_PUSH = 1e-3  # of half the hull's length: the gap after an impact


class Pose(NamedTuple):
    """Position and heading of a hull."""

    north_m: float
    east_m: float
    heading_rad: float


class Velocity(NamedTuple):
    """Of the water over ground."""

    north_m_s: float
    east_m_s: float


class Touch(NamedTuple):
    """Where, in body axes about the centre, and the normal there, a unit vector toward the hull."""

    ahead_m: float
    starboard_m: float
    normal_ahead: float
    normal_starboard: float


class Contact:
    """Contact of one hull with shore and movers.

    room_m is the distance that the hull can travel before it can touch the shore; the owner subtracts its
    travel, and calls `meets` when none is left or if is_watchful (there are movers). is_stuck: a soft shore
    holds the hull.
    """

    def __init__(self, hull: HullSettings, shore: Shore, movers: Movers, hold_n: float) -> None:
        """The shore must be able to answer for the hull's length."""
        half, side = 0.5 * hull.length_m, 0.5 * hull.beam_m
        transom = hull.transom_share * side
        self._corners = (
            (half, 0.0), (0.0, side), (-half, transom), (-half, -transom), (0.0, -side),
        )  # fmt: skip
        self._radius_m = max(side, math.hypot(half, transom))
        self._lever_m = half
        self._shore, self._movers, self._hold_n = shore, movers, hold_n
        self.room_m = 0.0
        self._has_cast_off = False
        self.is_stuck = False
        self.is_watchful = bool(movers)

    def meets(
        self,
        hull: Hull,
        before: Pose,
        current: Velocity,
        dt_s: float,
        time_s: float,
    ) -> bool:
        """Whether the step that brought the hull here from the pose before made it touch.

        If so, pose and velocity are put right. A boat that starts alongside rubs as it casts off: that is no
        touch yet, until it first has had room to turn on the spot.
        """
        if self.is_stuck and self._holds(hull, before, current, dt_s):
            return self._has_cast_off
        if self.room_m > 0.0 and (
            not self._movers or self._movers.gap_m(hull.east_m, hull.north_m, time_s) > self._radius_m
        ):
            return False
        touches = self._touches(hull, time_s)
        if not touches:
            self.room_m = self._shore.room_m(hull.east_m, hull.north_m) - self._radius_m
            self._has_cast_off = self._has_cast_off or self.room_m > 0.0
            return False
        self.room_m = 0.0
        if self._hold_n > 0.0:
            self.is_stuck = True
        else:
            for attempt in range(1, _ATTEMPTS + 1):
                push_north = push_east = 0.0
                for touch in touches:
                    apply_contact(hull, touch, current)
                    push_north += touch.normal_ahead * hull.cos - touch.normal_starboard * hull.sin
                    push_east += touch.normal_ahead * hull.sin + touch.normal_starboard * hull.cos
                push_m = attempt * _PUSH * self._lever_m
                hull.place(
                    before.north_m + dt_s * (hull.water_north_m_s + current.north_m_s) + push_m * push_north,
                    before.east_m + dt_s * (hull.water_east_m_s + current.east_m_s) + push_m * push_east,
                    before.heading_rad + dt_s * hull.yaw_rate_rad_s,
                )
                touches = self._touches(hull, time_s)
                if not touches:
                    return self._has_cast_off
            if self._gets_free(hull, before, time_s):
                return self._has_cast_off
        hull.place(*before)
        hull.hold(*current)
        return self._has_cast_off

    def _gets_free(self, hull: Hull, before: Pose, time_s: float) -> bool:
        """Whether a hull that was in contact before, as a mover may leave it, now is less so."""
        now = Pose(hull.north_m, hull.east_m, hull.heading_rad)
        hull.place(*before)
        was_in_contact = bool(self._touches(hull, time_s))
        hull.place(*now)
        return was_in_contact and self._gap_m(now, time_s) > self._gap_m(before, time_s)

    def _holds(self, hull: Hull, before: Pose, current: Velocity, dt_s: float) -> bool:
        """Whether the shore can take the momentum that this step has given to the stopped hull."""
        along, across = _in_body_axes(hull, current)
        m11, m22, m33 = hull.inertia
        pull_n = (
            math.hypot(
                m11 * (hull.surge_m_s + along),
                m22 * (hull.sway_m_s + across),
                m33 * hull.yaw_rate_rad_s / self._lever_m,
            )
            / dt_s
        )
        self.is_stuck = pull_n <= self._hold_n
        if self.is_stuck:
            hull.place(*before)
            hull.hold(*current)
        return self.is_stuck

    def _gap_m(self, at: Pose, time_s: float) -> float:
        return min(
            self._shore.room_m(at.east_m, at.north_m), self._movers.gap_m(at.east_m, at.north_m, time_s)
        )

    def _touches(self, hull: Hull, time_s: float) -> list[Touch]:
        """Every stretch of shore and every mover that the hull's outline meets."""
        out: list[Touch] = []
        north_m, east_m, cos, sin = hull.north_m, hull.east_m, hull.cos, hull.sin
        reach = self._radius_m * self._radius_m
        for at_east, at_north, d_east, d_north, _ in self._shore.near(east_m, north_m):
            to_east, to_north = at_east - east_m, at_north - north_m
            share = -(to_east * d_east + to_north * d_north) / (d_east * d_east + d_north * d_north)
            share = 0.0 if share < 0.0 else min(share, 1.0)
            gap_east, gap_north = to_east + share * d_east, to_north + share * d_north
            if gap_east * gap_east + gap_north * gap_north > reach:
                continue
            start = to_north * cos + to_east * sin, to_east * cos - to_north * sin
            way = d_north * cos + d_east * sin, d_east * cos - d_north * sin
            nearest = gap_north * cos + gap_east * sin, gap_east * cos - gap_north * sin
            touch = crossing(self._corners, start, way, nearest)
            if touch is not None:
                out.append(touch)
        if self._movers:
            for at_east, at_north, radius_m in self._movers.positions_m(time_s):
                to_east, to_north = at_east - east_m, at_north - north_m
                if math.hypot(to_east, to_north) < radius_m + self._radius_m:
                    centre = to_north * cos + to_east * sin, to_east * cos - to_north * sin
                    touch = overlap(self._corners, centre, radius_m)
                    if touch is not None:
                        out.append(touch)
        return out


Place = tuple[float, float]


def crossing(corners: tuple[Place, ...], start: Place, way: Place, nearest: Place) -> Touch | None:
    """Where a stretch of shore from start along way crosses the outline, all in body axes.

    The normal points from the stretch's nearest point to the centre: square to a wall, away from a corner.
    """
    count, ahead, starboard = 0, 0.0, 0.0
    x, y = corners[-1]
    for next_x, next_y in corners:
        side_x, side_y = next_x - x, next_y - y
        across = way[0] * side_y - way[1] * side_x
        if across != 0.0:
            gap_x, gap_y = x - start[0], y - start[1]
            along = (gap_x * side_y - gap_y * side_x) / across
            on_side = (gap_x * way[1] - gap_y * way[0]) / across
            if 0.0 <= along <= 1.0 and 0.0 <= on_side <= 1.0:
                count += 1
                ahead += start[0] + along * way[0]
                starboard += start[1] + along * way[1]
        x, y = next_x, next_y
    if not count:
        return None
    return _touch(ahead / count, starboard / count, -nearest[0], -nearest[1])


def overlap(corners: tuple[Place, ...], centre: Place, radius_m: float) -> Touch | None:
    """Where a circle reaches into the outline, all in body axes."""
    best = math.inf
    ahead = starboard = 0.0
    x, y = corners[-1]
    for next_x, next_y in corners:
        side_x, side_y = next_x - x, next_y - y
        share = ((centre[0] - x) * side_x + (centre[1] - y) * side_y) / (side_x * side_x + side_y * side_y)
        share = min(max(share, 0.0), 1.0)
        at_x, at_y = x + share * side_x, y + share * side_y
        gap_m = math.hypot(at_x - centre[0], at_y - centre[1])
        if gap_m < best:
            best, ahead, starboard = gap_m, at_x, at_y
        x, y = next_x, next_y
    if best > radius_m and not _holds_point(corners, centre):
        return None
    return _touch(ahead, starboard, -centre[0], -centre[1])


def _holds_point(corners: tuple[Place, ...], place: Place) -> bool:
    """Whether a point lies inside the outline, whose corners go clockwise."""
    x, y = corners[-1]
    for next_x, next_y in corners:
        if (next_x - x) * (place[1] - y) - (next_y - y) * (place[0] - x) < 0.0:
            return False
        x, y = next_x, next_y
    return True


def _touch(ahead_m: float, starboard_m: float, normal_ahead: float, normal_starboard: float) -> Touch:
    size = math.hypot(normal_ahead, normal_starboard)
    if size == 0.0:  # the shore runs through the centre: any direction will do
        return Touch(ahead_m, starboard_m, -1.0, 0.0)
    return Touch(ahead_m, starboard_m, normal_ahead / size, normal_starboard / size)


def _in_body_axes(hull: Hull, current: Velocity) -> tuple[float, float]:
    along = current.north_m_s * hull.cos + current.east_m_s * hull.sin
    return along, current.east_m_s * hull.cos - current.north_m_s * hull.sin


def apply_contact(hull: Hull, touch: Touch, current: Velocity) -> None:
    """Reduce the speed over ground along the shore by friction, and remove the speed into it."""
    m11, m22, m33 = hull.inertia
    along, across = _in_body_axes(hull, current)
    u, v, r = hull.surge_m_s + along, hull.sway_m_s + across, hull.yaw_rate_rad_s
    x, y, normal_x, normal_y = touch
    arm = x * normal_y - y * normal_x
    into = normal_x * (u - r * y) + normal_y * (v + r * x)
    if into >= 0.0:
        return
    normal_ease = normal_x * normal_x / m11 + normal_y * normal_y / m22 + arm * arm / m33
    most = -FRICTION * into / normal_ease
    reach = x * normal_x + y * normal_y  # the arm of the tangent, (−normal_y, normal_x)
    slip = -normal_y * (u - r * y) + normal_x * (v + r * x)
    rub = -slip / (normal_y * normal_y / m11 + normal_x * normal_x / m22 + reach * reach / m33)
    rub = min(max(rub, -most), most)
    u, v, r = u - rub * normal_y / m11, v + rub * normal_x / m22, r + rub * reach / m33
    into = normal_x * (u - r * y) + normal_y * (v + r * x)
    if into < 0.0:
        impulse = -into / normal_ease
        u, v, r = u + impulse * normal_x / m11, v + impulse * normal_y / m22, r + impulse * arm / m33
    hull.move(u - along, v - across, r)
