"""What the voyages of closed_loop share: modes by number, sticks, set-points, faults, missions."""

import math
from typing import Any

from boat_rig import BOAT, HOME_ITEM, OK, Rig, scenario, waypoint

from companion.core.geo import Point
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem
from sitl.run.mission_run import MissionRun
from sitl.world.faults.catalogue import FaultSetting

CURRENT = ("environment.current_m_s=0.5", "environment.current_to_deg=90.0")
GUSTS = ("environment.wind_m_s=5", "environment.gust_m_s=8", "environment.wind_from_deg=90")
POSITION, VELOCITY, YAW, YAW_RATE = 0b110111111000, 0b110111000111, 0b100111111111, 0b010111111111


def armed(mode: int, *settings: str, rig: Rig | None = None, **options: Any) -> Rig:  # noqa: ANN401
    """A boat armed in a mode. options: as Rig takes them."""
    rig = (rig or Rig("open", *settings, **options)).ready()
    assert rig.set_mode(mode) == OK
    assert rig.arm() == OK
    return rig


def go_to(rig: Rig, north_m: float, east_m: float) -> None:
    """DO_REPOSITION to a place of the scenario's frame."""
    place = rig.scenario.frame.to_global(Point(north_m, east_m))
    rig.peer.forget()
    rig.peer.command_int(192, -1, 1, 0, math.nan, x=deg_to_e7(place.lat_deg), y=deg_to_e7(place.lon_deg))
    rig.receive()
    assert [ack.result for ack in rig.peer.said("COMMAND_ACK")] == [OK]


def sail_to(rig: Rig, north_m: float, east_m: float, within_m: float = 4.0) -> None:
    """Go there in GUIDED."""
    go_to(rig, north_m, east_m)
    rig.until(lambda: rig.offset_m(north_m, east_m) < within_m, 90.0)


def push(rig: Rig, steering: int, throttle: int, seconds: float) -> None:
    """Sticks that a station holds."""
    for _ in range(round(seconds / 0.2)):
        rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, steering, throttle, 0, 0))
        rig.run(0.2)


def aim(
    rig: Rig, mask: int, *at: float, frame: int = 1, velocity: tuple[float, ...] = (0.0, 0.0),
    yaw: float = 0.0, rate: float = 0.0,
) -> None:  # fmt: skip
    """A set-point; at: north and east."""
    north_m, east_m = at or (0.0, 0.0)
    rig.peer.send(
        dialect.MAVLink_set_position_target_local_ned_message(
            0, *BOAT, frame, mask, north_m, east_m, 0, *velocity, 0, 0, 0, 0, yaw, rate
        )
    )


def keep_aiming(rig: Rig, seconds: float, mask: int, **values: Any) -> None:  # noqa: ANN401
    """A set-point twice a second."""
    for _ in range(round(seconds / 0.5)):
        aim(rig, mask, **values)
        rig.run(0.5)


def tells(rig: Rig, start: str) -> bool:
    """Whether a line that begins so was told."""
    return any(text.startswith(start) for text in rig.peer.texts)


def told(rig: Rig, start: str, limit_s: float) -> float:
    """Seconds until a line that begins so is told."""
    return rig.until(lambda: tells(rig, start), limit_s)


def drifted_m(rig: Rig, seconds: float) -> float:
    """How far the boat truly gets from here."""
    before, worst_m = rig.world.truth, 0.0
    for _ in range(round(seconds)):
        rig.run(1.0)
        worst_m = max(worst_m, rig.offset_m(before.north_m, before.east_m))
    return worst_m


def begin(rig: Rig, what: str, kind: str = "off", size: float | None = None) -> None:
    """A fault begins."""
    rig.world.electronics.faults.begin(FaultSetting(what=what, kind=kind, size=size))


def is_stopped(rig: Rig) -> bool:
    """Whether motors and rudder have no command."""
    command = rig.boat.command
    return (command.left, command.right, command.rudder) == (0.0, 0.0, 0.0)


def reached(rig: Rig) -> list[int]:
    """The items that stations were told of as reached."""
    return [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")]


def over(rig: Rig, limit_s: float = 300.0) -> list[int]:
    """Sail to the end of the mission; the items reached since the last call."""
    rig.until(lambda: rig.mode != "AUTO", limit_s)
    rig.run(0.1)
    found = reached(rig)
    rig.peer.forget()
    return found


def speed_m_s(rig: Rig) -> float:
    """Over ground, in truth."""
    return math.hypot(rig.world.truth.north_m_s, rig.world.truth.east_m_s)


def do(command: int, *params: float) -> MissionItem:
    """A command item as QGroundControl sends it: frame 2, the fifth parameter in x."""
    p = [*params, *[0.0] * (7 - len(params))]
    return MissionItem(2, command, 0, 1, p[0], p[1], p[2], p[3], int(p[4]), int(p[5]), p[6])


def mission_run(*places: tuple[float, float], settings: tuple[str, ...] = ()) -> MissionRun:
    """A mission to these places, not yet sailed."""
    return MissionRun(scenario("open", *settings), [HOME_ITEM, *(waypoint(*place) for place in places)])


def said(run: MissionRun) -> list[str]:
    """The texts of a run."""
    return [event.text for event in run.timeline.events if event.kind == "text"]
