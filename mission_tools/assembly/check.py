"""The plan linter: what in a mission would surprise a boat or its owner."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import shapely

from companion.core.geo import LatLon, Point, geodesic_m, longitude_difference_deg
from mission_tools.maps import Chart
from mission_tools.mission.mission import Command, Frame, Mission, MissionItem, command_name, plain_frame

NOWHERE = LatLon(0.0, 0.0)  # what programs write for a place that was never set
SAME_PLACE_M = 0.05
FAR_M = 50_000.0
TOUCH_M = 0.01  # a leg this much nearer than the clearance is still all right

BOAT_NAV = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LOITER_TURNS,
        Command.NAV_LOITER_TIME,
        Command.NAV_RETURN_TO_LAUNCH,
        Command.NAV_GUIDED_ENABLE,
        Command.NAV_DELAY,
        Command.NAV_SET_YAW_SPEED,
    }
)
NAV_LAST = 95  # MAV_CMD_NAV_LAST: up to here a number is a navigation command
FRAMES = frozenset({Frame.GLOBAL, Frame.GLOBAL_RELATIVE_ALT, Frame.MISSION})


@dataclass(frozen=True, slots=True)
class Finding:
    """Something wrong. `item` is the sequence number, home being 0; None: the mission as a whole."""

    item: int | None
    text: str

    def __str__(self) -> str:
        return self.text if self.item is None else f"item {self.item}: {self.text}"


def check_mission(mission: Mission, chart: Chart | None = None, clearance_m: float = 0.0) -> list[Finding]:
    """All findings, those of the mission as a whole first, then in the order of the items.

    chart: where the water is; without one, legs are not checked against land. clearance_m: how far from
    land, obstacles and keep-out areas every leg must stay.
    """
    if mission.home == NOWHERE:
        mission = replace(mission, home=None)
    findings = [*_as_a_whole(mission)]
    for seq, item in enumerate(mission.items, start=1):
        findings += [Finding(seq, text) for text in _item(item, len(mission.items))]
    findings += _distances(mission)
    if chart is not None:
        findings += in_the_way(mission, chart, clearance_m)
    return sorted(findings, key=lambda finding: -1 if finding.item is None else finding.item)


def _as_a_whole(mission: Mission) -> Iterator[Finding]:
    if mission.home is None:
        yield Finding(None, "no home: set the planned home position")
    if not mission.places:
        yield Finding(None, "no waypoint: the boat would go nowhere")


def _item(item: MissionItem, last_seq: int) -> Iterator[str]:
    is_navigation = item.command <= NAV_LAST or item.command == Command.NAV_SET_YAW_SPEED
    if is_navigation and item.command not in BOAT_NAV:
        yield f"{command_name(item.command)} is not something a boat can do"
    if plain_frame(item.frame) not in FRAMES:
        yield f"frame {int(item.frame)} is not one for a boat's mission: expected 3 (relative) or 0 (global)"
    elif item.command in BOAT_NAV and item.place is None and (item.x, item.y) != (0, 0):
        yield f"{command_name(item.command)} in frame {int(item.frame)}: its place would be ignored"
    if item.place == NOWHERE:
        yield "at latitude 0, longitude 0: the place was never set"
    if item.command == Command.DO_JUMP and not 1 <= item.params[0] <= last_seq:
        yield f"DO_JUMP to item {item.params[0]:g}, which does not exist"
    if item.command == Command.DO_CHANGE_SPEED and not (
        item.params[1] > 0.0 or item.params[1] in {-1.0, -2.0}
    ):
        yield f"DO_CHANGE_SPEED to {item.params[1]:g} m/s: expected more than 0"
    if item.command in {Command.NAV_WAYPOINT, Command.NAV_DELAY} and item.params[0] < 0.0:
        yield f"a wait of {item.params[0]:g} s is negative"


def _distances(mission: Mission) -> Iterator[Finding]:
    previous = mission.home
    for seq, item in enumerate(mission.items, start=1):
        if item.place is None or item.place == NOWHERE:
            continue
        if previous is not None:
            leg_m = geodesic_m(previous, item.place) if _is_near(previous, item.place) else math.inf
            if leg_m > FAR_M:
                yield Finding(seq, f"more than {FAR_M / 1000:.0f} km from the point before it")
            elif leg_m < SAME_PLACE_M and previous is not mission.home:
                yield Finding(seq, "the same place as the waypoint before it")
        previous = item.place


def _is_near(a: LatLon, b: LatLon) -> bool:
    """Whether a local frame at one reaches the other."""
    return abs(a.lat_deg - b.lat_deg) < 1.0 and abs(longitude_difference_deg(a.lon_deg, b.lon_deg)) < 2.0


def in_the_way(mission: Mission, chart: Chart, clearance_m: float) -> Iterator[Finding]:
    """Legs over land or too near to it. The first one starts at home, where a boat may lie at a jetty."""
    previous = None if mission.home is None else chart.frame.to_local(mission.home)
    for seq, item in enumerate(mission.items, start=1):
        if item.place is None or item.place == NOWHERE:
            continue
        at = chart.frame.to_local(item.place)
        where = chart.obstruction(at)
        if where is not None:
            yield Finding(seq, f"lies {where}")
        elif previous is not None:
            yield from _leg(seq, previous, at, chart, clearance_m)
        previous = at


def _leg(seq: int, start: Point, end: Point, chart: Chart, clearance_m: float) -> Iterator[Finding]:
    leg = shapely.LineString([(start.east_m, start.north_m), (end.east_m, end.north_m)])
    if not chart.navigable.covers(leg):
        dry = shapely.get_parts(leg.difference(chart.navigable))
        middle = dry[0].interpolate(0.5, normalized=True)
        what = chart.nearest_feature(Point(middle.y, middle.x))
        yield Finding(seq, f"the leg to it crosses land or a keep-out area: {what} is in the way")
        return
    # Beyond the start's own distance to the shore nothing better can be asked of the first metres.
    asked_m = min(clearance_m, chart.clearance_m(start) if seq == 1 else clearance_m) - TOUCH_M
    if asked_m > 0.0 and shapely.dwithin(chart.shores, leg, asked_m):
        nearest_m = chart.shores.distance(leg)
        near = shapely.shortest_line(leg, chart.shores).coords[1]
        what = chart.nearest_feature(Point(near[1], near[0]))
        yield Finding(seq, f"the leg to it passes {what} at {nearest_m:.2f} m, nearer than {clearance_m:g} m")
