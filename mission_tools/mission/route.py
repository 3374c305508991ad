"""A planned path as a mission."""

from collections.abc import Sequence

from companion.core.geo import LatLon
from mission_tools.errors import UsageError
from mission_tools.mission.mission import Mission, MissionItem

FASTEST_M_S = 100.0


def mission_along(path: Sequence[LatLon], speed_m_s: float | None = None) -> Mission:
    """Waypoints along a path whose first point is where the boat starts: that one becomes home.

    How near a waypoint must be passed is the vehicle's own setting. Raises UsageError: fewer than two points,
    or a speed out of range.
    """
    if len(path) < 2:
        raise UsageError(f"a route needs a start and a goal, got {len(path)} point(s)")
    home, *items = (MissionItem.at(place) for place in path)
    return with_speed(Mission(tuple(items), home=home.place), speed_m_s)


def with_speed(mission: Mission, speed_m_s: float | None) -> Mission:
    """The mission with its speed over ground as the first item; None leaves the speed to the vehicle. Raises
    UsageError: a speed out of range.
    """
    if speed_m_s is None:
        return mission
    if not 0.0 < speed_m_s < FASTEST_M_S:
        raise UsageError(
            f"--speed {speed_m_s:g}: expected metres per second, more than 0 and below {FASTEST_M_S:g}"
        )
    return mission.at_speed(speed_m_s)
