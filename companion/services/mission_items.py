"""MAVLink mission items → the vehicle's steps. What a boat cannot do is refused, naming item and field."""

import math
from collections.abc import Sequence

from companion.geo import LatLon
from companion.mavlink.dialect import dialect
from companion.mavlink.items import GLOBAL_FRAMES, Fault, MissionItem, MissionResult
from companion.units import e7_to_deg
from companion.vehicle.mission_steps import Home, Jump, ReturnHome, SetSpeed, Step, Wait, Waypoint

_PLACES = frozenset(
    {
        dialect.MAV_CMD_NAV_WAYPOINT,
        dialect.MAV_CMD_NAV_LOITER_UNLIM,
        dialect.MAV_CMD_NAV_LOITER_TIME,
    }
)


def to_step(seq: int, item: MissionItem) -> Step | Fault:
    """One item of a mission as something to sail, or why not. Sequence 0 is home and never sailed."""
    if seq == 0:
        return Home()
    if item.command in _PLACES:
        return _to_waypoint(item)
    match item.command:
        case dialect.MAV_CMD_NAV_RETURN_TO_LAUNCH:
            return ReturnHome()
        case dialect.MAV_CMD_NAV_DELAY:
            return _not_negative(item.param1, "delay", Wait(item.param1))
        case dialect.MAV_CMD_DO_CHANGE_SPEED:
            speed_m_s = item.param2
            if math.isnan(speed_m_s) or math.isinf(speed_m_s):
                return Fault(MissionResult.INVALID_PARAM2, f"speed {speed_m_s} is not a number")
            return SetSpeed(max(speed_m_s, 0.0))  # −1 and −2 mean "as it is" and "the default"
        case dialect.MAV_CMD_DO_JUMP:
            return _to_jump(item)
    return Fault(MissionResult.UNSUPPORTED, f"command {item.command} is nothing this boat can do")


def check_jumps(steps: Sequence[Step]) -> Fault | None:
    """Jump targets can only be checked once the whole list is there."""
    for seq, step in enumerate(steps):
        if isinstance(step, Jump) and not 1 <= step.target < len(steps):
            text = f"item {seq} jumps to {step.target}, the list ends at {len(steps) - 1}"
            return Fault(MissionResult.INVALID_PARAM1, text)
    return None


def _to_waypoint(item: MissionItem) -> Step | Fault:
    if item.frame not in GLOBAL_FRAMES:
        return Fault(MissionResult.UNSUPPORTED_FRAME, f"frame {item.frame} is not a global frame")
    if item.x == 0 and item.y == 0:
        return Fault(MissionResult.INVALID_PARAM5_X, "position 0, 0 is nowhere")
    if not abs(item.x) <= 900_000_000:
        return Fault(MissionResult.INVALID_PARAM5_X, f"latitude {e7_to_deg(item.x)} is outside ±90")
    if not abs(item.y) <= 1_800_000_000:
        return Fault(MissionResult.INVALID_PARAM6_Y, f"longitude {e7_to_deg(item.y)} is outside ±180")
    place = LatLon(e7_to_deg(item.x), e7_to_deg(item.y))
    if item.command == dialect.MAV_CMD_NAV_LOITER_UNLIM:
        return Waypoint(place, math.inf)
    radius_m = item.param2 if item.command == dialect.MAV_CMD_NAV_WAYPOINT and item.param2 > 0.0 else 0.0
    hold_s = 0.0 if math.isnan(item.param1) else item.param1
    return _not_negative(
        hold_s, "time", Waypoint(place, hold_s, radius_m if math.isfinite(radius_m) else 0.0)
    )


def _to_jump(item: MissionItem) -> Step | Fault:
    for result, value in (
        (MissionResult.INVALID_PARAM1, item.param1),
        (MissionResult.INVALID_PARAM2, item.param2),
    ):
        if not math.isfinite(value) or value != int(value):
            return Fault(result, f"jump parameter {value} is not a whole number")
    return Jump(int(item.param1), int(item.param2))


def _not_negative(seconds: float, name: str, step: Step) -> Step | Fault:
    if not 0.0 <= seconds < math.inf:
        return Fault(MissionResult.INVALID_PARAM1, f"{name} {seconds} s is not a time")
    return step
