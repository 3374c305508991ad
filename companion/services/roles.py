"""Roles on the network, from heartbeats: operator, planner, logger, vehicle.

Only the operator resets the operator failsafe and may steer manually. A ground station is the operator if
`identity.operator_system_id` names it or is 0.
"""

from collections import OrderedDict
from enum import Enum

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect

MAX_STATIONS = 64


class Role(Enum):
    """Role of a station or program."""

    OPERATOR = "operator"
    OTHER_STATION = "ground station"  # a ground station that is not the configured operator
    PLANNER = "planner"
    LOGGER = "logger"
    VEHICLE = "vehicle"
    PART = "part"  # a camera, a gimbal, a radio …
    UNKNOWN = "unknown"


def role_of(heartbeat: Message, sender: Address, operator_system_id: int) -> Role:
    """The role that a heartbeat announces. operator_system_id: 0: any ground station."""
    if heartbeat.type == dialect.MAV_TYPE_GCS:
        is_chosen = operator_system_id in (0, sender.system)
        return Role.OPERATOR if is_chosen else Role.OTHER_STATION
    if sender.component == dialect.MAV_COMP_ID_LOG:
        return Role.LOGGER
    if heartbeat.type == dialect.MAV_TYPE_ONBOARD_CONTROLLER:
        return Role.PLANNER
    if heartbeat.autopilot != dialect.MAV_AUTOPILOT_INVALID:
        return Role.VEHICLE
    return Role.PART


class Roles:
    """The latest role of each sender, at most MAX_STATIONS."""

    def __init__(self) -> None:
        self._roles: OrderedDict[Address, Role] = OrderedDict()

    def update(self, heartbeat: Message, sender: Address, operator_system_id: int) -> Role:
        role = role_of(heartbeat, sender, operator_system_id)
        self._roles[sender] = role
        self._roles.move_to_end(sender)
        if len(self._roles) > MAX_STATIONS:
            self._roles.popitem(last=False)
        return role

    def of(self, sender: Address) -> Role:
        return self._roles.get(sender, Role.UNKNOWN)
