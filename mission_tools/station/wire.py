"""How this client names itself, and the messages that several of its parts send."""

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, component_heartbeat, dialect

AUTOPILOT = 1  # the component of a boat that answers commands
OWN_COMPONENT: int = dialect.MAV_COMP_ID_MISSIONPLANNER  # as ground stations name themselves


def heartbeat(is_operator: bool) -> Message:
    """An operator's heartbeats hold off the boat's failsafe OPERATOR_LOST; those of other programs do not."""
    return component_heartbeat(dialect.MAV_TYPE_GCS if is_operator else dialect.MAV_TYPE_ONBOARD_CONTROLLER)


def command_long(boat: Address, number: int, *params: float, repeat: int = 0) -> Message:
    """COMMAND_LONG; missing parameters are 0."""
    values = [*params, *([0.0] * (7 - len(params)))]
    message: Message = dialect.MAVLink_command_long_message(*boat, number, repeat, *values)
    return message
