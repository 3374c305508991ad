"""The old go-to: a mission item of its own, outside every list."""

from companion.core.requests import GoTo
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import ItemFault, MissionItem, MissionResult
from companion.services.missions.items import global_position
from companion.vehicle.vehicle import Vehicle

_GUIDED_ITEM, _ALTITUDE_ITEM = 2, 3  # MISSION_ITEM.current of ArduPilot's old go-to and change of altitude


def on_guided_item(message: Message, vehicle: Vehicle) -> MissionResult:
    """QGroundControl's first go-to, a mission item with current = 2."""
    if message.current == _ALTITUDE_ITEM:
        return MissionResult.ACCEPTED  # altitude has no effect
    if message.current != _GUIDED_ITEM:
        return MissionResult.INVALID
    item = MissionItem.from_message(message)
    if isinstance(item, ItemFault):
        return item.result
    if item.command != dialect.MAV_CMD_NAV_WAYPOINT:
        return MissionResult.UNSUPPORTED
    position = global_position(item)
    if isinstance(position, ItemFault):
        return position.result
    return MissionResult.ACCEPTED if vehicle.request(GoTo(position)).accepted else MissionResult.ERROR
