"""The voyage that tells a boat's parameters: at each of several speeds a straight leg, a stop, turns on the
spot, a zigzag and a circle. It takes about ten minutes, and open water of 35 s by 40 s at cruise speed.
"""

from collections.abc import Callable, Iterator
from typing import Final

from companion.core.geo import LatLon, LocalFrame, Point, from_body_axes
from mission_tools.mission.mission import Command, Frame, Mission, MissionItem, speed_item

SPEEDS: Final = (0.5, 1.0, 1.6)
"""Of cruise speed; the last is more than most boats' full throttle gives."""
_UNIT_S: Final = 10.0  # lengths are so many seconds at cruise speed
_STOP_S: Final = 15.0  # three to five time constants of a boat of this size
_TURN_DEG: Final = 150.0


def trial_mission(start: LatLon, cruise_m_s: float, heading_rad: float = 0.0) -> Mission:
    """The voyage from a place, its straight legs along a heading, the rest to starboard of them."""
    frame, unit_m = LocalFrame(start), _UNIT_S * cruise_m_s

    def at(ahead: float, aside: float) -> LatLon:
        place = from_body_axes(unit_m * ahead, unit_m * aside, heading_rad)
        return frame.to_global(Point(place.north_m, place.east_m))

    items = [item for number in range(len(SPEEDS)) for item in _round(number, cruise_m_s, unit_m, at)]
    return Mission(tuple(items), home=start)


def _round(
    number: int, cruise_m_s: float, unit_m: float, at: Callable[[float, float], LatLon]
) -> Iterator[MissionItem]:
    """Out and back at one speed."""
    aside = 1.4 * number
    way = 1.0 if number % 2 else -1.0
    yield speed_item(SPEEDS[number] * cruise_m_s)
    yield MissionItem.at(at(0.0, aside))
    yield MissionItem.at(at(3.5, aside))
    yield _plain(Command.NAV_DELAY, _STOP_S)
    yield _plain(Command.CONDITION_YAW, _TURN_DEG, 0.0, way, 1.0)
    yield _plain(Command.CONDITION_YAW, _TURN_DEG, 0.0, -way, 1.0)
    for leg in range(1, 6):
        yield MissionItem.at(at(3.5 - 0.5 * leg, aside + 0.5 * (leg % 2)))
    circle = (1.0, 0.0, way * 0.4 * unit_m, 0.0)
    yield MissionItem.at(at(0.5, aside + 0.4), Command.NAV_LOITER_TURNS, circle)


def _plain(command: Command, *params: float) -> MissionItem:
    p1, p2, p3, p4 = (*params, 0.0, 0.0, 0.0)[:4]
    return MissionItem(command, Frame.MISSION, (p1, p2, p3, p4))
