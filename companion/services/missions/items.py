"""Converts MAVLink mission items to mission steps. Unsupported items are refused by item and field."""

import math
from collections.abc import Callable, Sequence

from companion.core.geo import LatLon, Point
from companion.core.units import e7_to_deg
from companion.mavlink.dialect import constants, dialect
from companion.mavlink.items import GLOBAL_FRAMES, ItemFault, MissionItem, MissionResult
from companion.payload.actions import ActionFault
from companion.payload.fitted import CAMERA, FittedPayload
from companion.services.payload.rows import ROWS, read_action
from companion.vehicle.mission import steps
from companion.vehicle.mission.steps import Step

HIGHEST_M = 83_000.0  # ArduPilot's limit: 24 bits of centimetres
_NONE = FittedPayload()
_LOCAL_SCALE = 1e-4  # x and y of a local frame are in tenths of a millimetre

# Mount and markers are skipped, with a report to the operator; so are cameras on a boat without one. Takeoff:
# QGroundControl's templates begin with it for a boat too
IGNORED = constants(
    "MAV_CMD",
    *("NAV_TAKEOFF", "DO_LAND_START", "DO_CONTROL_VIDEO", "VIDEO_START_CAPTURE", "VIDEO_STOP_CAPTURE"),
    *("DO_SET_ROI", "DO_SET_ROI_LOCATION", "DO_SET_ROI_NONE", "DO_SET_ROI_SYSID", "DO_SET_ROI_WPNEXT_OFFSET"),
    *("DO_DIGICAM_CONFIGURE", "SET_CAMERA_MODE", "DO_MOUNT_CONFIGURE", "DO_MOUNT_CONTROL"),
    "DO_GIMBAL_MANAGER_PITCHYAW",
)

SAILED_STRAIGHT = frozenset({dialect.MAV_CMD_NAV_SPLINE_WAYPOINT})
"""Waypoints without their curve, with a report to the operator."""

# Refused explicitly, as the operator may rely on them
_REFUSED = {dialect.MAV_CMD_DO_SET_REVERSE: "this boat does not sail its legs astern"}


def command_name(command: int) -> str:
    """A command's number, with its name if it has one."""
    entry = dialect.enums["MAV_CMD"].get(command)
    return f"command {command}" + (f" ({entry.name.removeprefix('MAV_CMD_')})" if entry else "")


def to_step(seq: int, item: MissionItem, fitted: FittedPayload = _NONE) -> Step | ItemFault:
    """A mission item as a step, or the reason for its refusal. Sequence 0 is home.

    fitted: the boat's payload.
    """
    if seq == 0:
        return steps.Home()
    if item.command in IGNORED:
        return steps.Skip()
    if item.command in ROWS:
        return _act(item, fitted)
    translate = _TABLE.get(item.command)
    if translate is None:
        why = _REFUSED.get(item.command, "not supported")
        return ItemFault(MissionResult.UNSUPPORTED, f"{command_name(item.command)}: {why}")
    return translate(item)


def _act(item: MissionItem, fitted: FittedPayload) -> Step | ItemFault:
    p = (item.param1, item.param2, item.param3, item.param4, float(item.x), float(item.y), item.z)
    action = read_action(item.command, p, fitted)
    if not isinstance(action, ActionFault):
        return steps.Act(action)
    if action.is_absent and (fitted.is_skipped or ROWS[item.command].payload == CAMERA):
        return steps.Skip()
    result = MissionResult.UNSUPPORTED
    if action.parameter:
        result = MissionResult(MissionResult.INVALID_PARAM1 + action.parameter - 1)
    return ItemFault(result, f"{command_name(item.command)}: {action.text}")


def check_jumps(mission: Sequence[Step]) -> ItemFault | None:
    """Check the jump targets of a complete list."""
    for seq, step in enumerate(mission):
        if isinstance(step, steps.Jump) and not 1 <= step.target < len(mission):
            text = f"item {seq} jumps to {step.target}, the list ends at {len(mission) - 1}"
            return ItemFault(MissionResult.INVALID_PARAM1, text)
    return None


def global_position(item: MissionItem) -> LatLon | ItemFault:
    """The global position of an item, or the reason why it is invalid."""
    if item.frame not in GLOBAL_FRAMES:
        return ItemFault(MissionResult.UNSUPPORTED_FRAME, f"frame {item.frame} is not a global frame")
    if item.x == 0 and item.y == 0:
        return ItemFault(MissionResult.INVALID_PARAM5_X, "position 0, 0 is not valid")
    if not abs(item.x) <= 900_000_000:
        return ItemFault(MissionResult.INVALID_PARAM5_X, f"latitude {e7_to_deg(item.x)} is outside ±90")
    if fault := _altitude_fault(item):
        return fault
    if not abs(item.y) <= 1_800_000_000:
        return ItemFault(MissionResult.INVALID_PARAM6_Y, f"longitude {e7_to_deg(item.y)} is outside ±180")
    return LatLon(e7_to_deg(item.x), e7_to_deg(item.y))


def _place(item: MissionItem) -> steps.Place | ItemFault:
    """MAV_FRAME_LOCAL_NED is relative to the origin of the local frame, as LOCAL_POSITION_NED;
    MAV_FRAME_LOCAL_OFFSET_NED to the start of the leg.
    """
    if fault := _altitude_fault(item):
        return fault
    if item.frame == dialect.MAV_FRAME_LOCAL_NED:
        return Point(item.x * _LOCAL_SCALE, item.y * _LOCAL_SCALE)
    if item.frame == dialect.MAV_FRAME_LOCAL_OFFSET_NED:
        return steps.Offset(item.x * _LOCAL_SCALE, item.y * _LOCAL_SCALE)
    if item.frame not in GLOBAL_FRAMES:
        text = f"frame {item.frame} is neither global nor LOCAL_NED (1) nor LOCAL_OFFSET_NED (7)"
        return ItemFault(MissionResult.UNSUPPORTED_FRAME, text)
    return global_position(item)


def _altitude_fault(item: MissionItem) -> ItemFault | None:
    """Altitudes are ignored, but an invalid one means a damaged list."""
    if abs(item.z) <= HIGHEST_M:
        return None
    return ItemFault(MissionResult.INVALID_PARAM7, f"altitude {item.z:g} m is not valid")


def _waypoint(item: MissionItem) -> Step | ItemFault:
    """Also a place to stay at, for a time or for ever; its param2 is no radius."""
    place = _place(item)
    if isinstance(place, ItemFault):
        return place
    if item.command == dialect.MAV_CMD_NAV_LOITER_UNLIM:
        return steps.Waypoint(place, math.inf)
    has_radius = item.command != dialect.MAV_CMD_NAV_LOITER_TIME and 0.0 < item.param2 < math.inf
    hold_s = 0.0 if math.isnan(item.param1) else item.param1
    return _not_negative(hold_s, "time", steps.Waypoint(place, hold_s, item.param2 if has_radius else 0.0))


def _loiter_turns(item: MissionItem) -> Step | ItemFault:
    place = _place(item)
    if isinstance(place, ItemFault):
        return place
    if not 0.0 < item.param1 < math.inf:
        return ItemFault(MissionResult.INVALID_PARAM1, f"{item.param1} is not a number of turns")
    radius_m = 0.0 if math.isnan(item.param3) else item.param3
    if math.isinf(radius_m):
        return ItemFault(MissionResult.INVALID_PARAM3, f"radius {radius_m} m is not a radius")
    return steps.GoRound(place, item.param1, abs(radius_m), clockwise=radius_m >= 0.0)


def _delay(item: MissionItem) -> Step | ItemFault:
    if item.param1 == -1.0:
        return ItemFault(MissionResult.INVALID_PARAM1, "delay -1, until a time of day, is not supported")
    return _not_negative(item.param1, "delay", steps.Wait(item.param1))


def _speed(item: MissionItem) -> Step | ItemFault:
    speed_m_s = item.param2
    if not math.isfinite(speed_m_s):
        return ItemFault(MissionResult.INVALID_PARAM2, f"speed {speed_m_s} is not a number")
    return steps.SetSpeed(max(speed_m_s, 0.0))  # −1 and −2 mean "as it is" and "the default"


def _set_home(item: MissionItem) -> Step | ItemFault:
    if item.param1 == 1.0:
        return steps.MoveHome(None)
    place = global_position(item)
    return place if isinstance(place, ItemFault) else steps.MoveHome(place)


def _turn(item: MissionItem) -> Step | ItemFault:
    if not math.isfinite(item.param1):
        return ItemFault(MissionResult.INVALID_PARAM1, f"heading {item.param1} is not a number")
    is_relative = item.param4 == 1.0
    side = -1.0 if is_relative and item.param3 < 0.0 else 1.0
    return steps.Turn(math.radians(side * item.param1), is_relative)


def _limits(item: MissionItem) -> Step | ItemFault:
    timeout_s = 0.0 if math.isnan(item.param1) else item.param1
    distance_m = 0.0 if math.isnan(item.param4) else item.param4
    if not 0.0 <= distance_m < math.inf:
        return ItemFault(MissionResult.INVALID_PARAM4, f"distance {distance_m} m is not a distance")
    return _not_negative(timeout_s, "time-out", steps.LimitHandOver(timeout_s, distance_m))


def _within(item: MissionItem) -> Step | ItemFault:
    if not 0.0 <= item.param1 < math.inf:
        return ItemFault(MissionResult.INVALID_PARAM1, f"distance {item.param1} m is not a distance")
    return steps.WithinDistance(item.param1)


def _enable_fence(item: MissionItem) -> Step | ItemFault:
    match item.param1:
        case 0.0 | 1.0:
            return steps.EnableFence(item.param1 == 1.0)
        case 2.0:  # only the floor, which a boat does not have
            return steps.Skip()
        case value:
            return ItemFault(MissionResult.INVALID_PARAM1, f"{value:g} is neither 0 nor 1")


def _jump(item: MissionItem) -> Step | ItemFault:
    for result, value in (
        (MissionResult.INVALID_PARAM1, item.param1),
        (MissionResult.INVALID_PARAM2, item.param2),
    ):
        if not math.isfinite(value) or value != int(value):
            return ItemFault(result, f"jump parameter {value} is not a whole number")
    return steps.Jump(int(item.param1), int(item.param2))


def _not_negative(seconds: float, name: str, step: Step) -> Step | ItemFault:
    if not 0.0 <= seconds < math.inf:
        return ItemFault(MissionResult.INVALID_PARAM1, f"{name} {seconds} s is not a time")
    return step


_TABLE: dict[int, Callable[[MissionItem], Step | ItemFault]] = {
    dialect.MAV_CMD_NAV_WAYPOINT: _waypoint,
    **dict.fromkeys(SAILED_STRAIGHT, _waypoint),
    dialect.MAV_CMD_NAV_LOITER_UNLIM: _waypoint,
    dialect.MAV_CMD_NAV_LOITER_TURNS: _loiter_turns,
    dialect.MAV_CMD_NAV_LOITER_TIME: _waypoint,
    dialect.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda _: steps.ReturnHome(),
    dialect.MAV_CMD_NAV_GUIDED_ENABLE: lambda item: steps.HandOver(item.param1 > 0.5),
    dialect.MAV_CMD_NAV_DELAY: _delay,
    dialect.MAV_CMD_CONDITION_DELAY: lambda item: _not_negative(
        item.param1, "delay", steps.AfterDelay(item.param1)
    ),
    dialect.MAV_CMD_CONDITION_DISTANCE: _within,
    dialect.MAV_CMD_CONDITION_YAW: _turn,
    dialect.MAV_CMD_DO_JUMP: _jump,
    dialect.MAV_CMD_DO_CHANGE_SPEED: _speed,
    dialect.MAV_CMD_DO_FENCE_ENABLE: _enable_fence,
    dialect.MAV_CMD_DO_SET_HOME: _set_home,
    dialect.MAV_CMD_DO_GUIDED_LIMITS: _limits,
}
