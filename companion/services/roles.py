"""Who is who on the network, by the type and ids of their heartbeats: operator, planner, logger, vehicle.

Only the operator may silence the operator failsafe and hold the sticks. A ground station is the operator
where `identity.operator_system_id` says so, or leaves it open.
"""

from collections import OrderedDict
from enum import Enum

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect

MAX_STATIONS = 64

_LOGGERS = frozenset((dialect.MAV_COMP_ID_LOG,))
_PLANNERS = frozenset((dialect.MAV_TYPE_ONBOARD_CONTROLLER,))


class Role(Enum):
    """What somebody on the network is to this boat."""

    OPERATOR = "operator"
    OTHER_STATION = "ground station"  # a ground station that is not the chosen operator
    PLANNER = "planner"
    LOGGER = "logger"
    VEHICLE = "vehicle"
    PART = "part"  # a camera, a gimbal, a radio …
    UNKNOWN = "unknown"


def role_of(heartbeat: Message, sender: Address, operator_system_id: int) -> Role:
    """The role that a heartbeat announces. operator_system_id: 0 takes any ground station for him."""
    if heartbeat.type == dialect.MAV_TYPE_GCS:
        is_chosen = operator_system_id in (0, sender.system)
        return Role.OPERATOR if is_chosen else Role.OTHER_STATION
    if sender.component in _LOGGERS:
        return Role.LOGGER
    if heartbeat.type in _PLANNERS:
        return Role.PLANNER
    if heartbeat.autopilot != dialect.MAV_AUTOPILOT_INVALID:
        return Role.VEHICLE
    return Role.PART


class Roles:
    """Remembers what everyone has announced, the latest MAX_STATIONS of them."""

    def __init__(self) -> None:
        self._roles: OrderedDict[Address, Role] = OrderedDict()

    def update(self, heartbeat: Message, sender: Address, operator_system_id: int) -> Role:
        """Somebody announces itself."""
        role = role_of(heartbeat, sender, operator_system_id)
        self._roles[sender] = role
        self._roles.move_to_end(sender)
        if len(self._roles) > MAX_STATIONS:
            self._roles.popitem(last=False)
        return role

    def of(self, sender: Address) -> Role:
        """What somebody has announced to be."""
        return self._roles.get(sender, Role.UNKNOWN)
