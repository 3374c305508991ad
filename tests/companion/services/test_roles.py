import pytest
from boat_rig import PLANNER, QGC

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.services.roles import MAX_STATIONS, Role, Roles, role_of

GCS, ONBOARD, CAMERA, BOAT, NONE, ARDUPILOT = 6, 18, 30, 11, 8, 3


def beat(mav_type: int, autopilot: int = NONE) -> Message:
    message: Message = dialect.MAVLink_heartbeat_message(mav_type, autopilot, 0, 0, 4, 3)
    return message


@pytest.mark.parametrize(
    ("heartbeat", "sender", "operator", "role"),
    [
        (beat(GCS), QGC, 0, Role.OPERATOR),
        (beat(GCS), QGC, 255, Role.OPERATOR),
        (beat(GCS), QGC, 254, Role.OTHER_STATION),
        (beat(ONBOARD), PLANNER, 0, Role.PLANNER),
        (beat(ONBOARD), Address(1, 155), 0, Role.LOGGER),
        (beat(BOAT, ARDUPILOT), Address(2, 1), 0, Role.VEHICLE),
        (beat(CAMERA), Address(1, 100), 0, Role.PART),
    ],
)
def test_a_heartbeat_says_what_somebody_is(
    heartbeat: Message, sender: Address, operator: int, role: Role
) -> None:
    assert role_of(heartbeat, sender, operator) is role


def test_a_flood_of_stations_is_bounded_and_the_latest_are_known() -> None:
    roles = Roles()
    for component in range(1, 200):
        roles.update(beat(ONBOARD), Address(9, component), 0)
    assert roles.of(Address(9, 199)) is Role.PLANNER
    assert roles.of(Address(9, 199 - MAX_STATIONS)) is Role.UNKNOWN
