import pytest
from boat_rig import BOAT, OK, PLANNER, Rig

from companion.core.requests import ManualControl
from companion.mavlink.dialect import Message, dialect

INVALID, KEEP, RELEASE = 0x7FFF, 0xFFFF, 0


def sticks(y: int, z: int, target: int = 1) -> Message:
    message: Message = dialect.MAVLink_manual_control_message(target, 0, y, z, 0, 0)
    return message


def override(steering: int, throttle: int) -> Message:
    message: Message = dialect.MAVLink_rc_channels_override_message(
        *BOAT, steering, 0, throttle, 0, 0, 0, 0, 0
    )
    return message


@pytest.fixture
def rig() -> Rig:
    """An armed boat in MANUAL."""
    rig = Rig().ready()
    assert rig.set_mode(0) == OK
    assert rig.arm() == OK
    return rig


def taken(rig: Rig) -> ManualControl:
    rig.receive()
    return rig.boat.vehicle.manual_input.latest


@pytest.mark.parametrize(
    ("y", "z", "throttle", "steering"),
    [(0, 1000, 1.0, 0.0), (-1000, 0, 0.0, -1.0), (500, -250, -0.25, 0.5), (32000, -32000, -1.0, 1.0)],
)
def test_y_steers_and_z_is_the_throttle(rig: Rig, y: int, z: int, throttle: float, steering: float) -> None:
    rig.peer.send(sticks(y, z))
    assert taken(rig) == ManualControl(throttle, steering)


@pytest.mark.parametrize(("y", "z"), [(INVALID, 500), (500, INVALID), (INVALID, INVALID)])
def test_a_message_with_an_invalid_axis_is_ignored(rig: Rig, y: int, z: int) -> None:
    rig.peer.send(sticks(0, 300))
    before = taken(rig)
    rig.run(0.5)
    rig.peer.send(sticks(y, z))
    assert taken(rig) == before
    rig.run(0.7)  # and it does not keep the last one fresh either
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)


def test_sticks_for_another_boat_are_left_to_it(rig: Rig) -> None:
    rig.peer.send(sticks(0, 1000, target=2))
    assert taken(rig) == ManualControl(0.0, 0.0)


@pytest.mark.parametrize(
    ("steering_us", "throttle_us", "expected"),
    [
        (1500, 2000, ManualControl(1.0, 0.0)),
        (1000, 1500, ManualControl(0.0, -1.0)),
        (1750, 1250, ManualControl(-0.5, 0.5)),
        (900, 2300, ManualControl(1.0, -1.0)),
    ],
)
def test_rc_override_is_read_around_the_centre(
    rig: Rig, steering_us: int, throttle_us: int, expected: ManualControl
) -> None:
    rig.peer.send(override(steering_us, throttle_us))
    assert taken(rig) == expected


def test_a_released_axis_is_centred_and_an_ignored_one_keeps_its_value(rig: Rig) -> None:
    rig.peer.send(override(1600, 1800))
    rig.peer.send(override(KEEP, 1900))
    assert taken(rig) == ManualControl(0.8, 0.2)
    rig.peer.send(override(1500, KEEP))
    assert taken(rig) == ManualControl(0.8, 0.0)
    rig.peer.send(override(1500, RELEASE))
    assert taken(rig) == ManualControl(0.0, 0.0)


def test_an_axis_of_long_ago_does_not_come_back(rig: Rig) -> None:
    rig.peer.send(override(1500, 2000))
    taken(rig)
    rig.run(2.0)
    rig.peer.send(override(1600, KEEP))
    assert taken(rig) == ManualControl(0.0, 0.2)


def test_an_override_that_ignores_all_axes_keeps_nothing_fresh(rig: Rig) -> None:
    rig.peer.send(override(1500, 1800))
    for _ in range(20):
        rig.run(0.1)
        rig.peer.send(override(KEEP, KEEP))
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)


def test_only_the_chosen_operator_has_his_hand_on_the_boat() -> None:
    rig = Rig(config={"identity.operator_system_id": 255}).ready()
    planner = rig.connect(PLANNER)
    planner.send(sticks(0, 1000))
    planner.send(override(1500, 2000))
    assert taken(rig) == ManualControl(0.0, 0.0)
    rig.peer.send(sticks(0, 500))
    assert taken(rig) == ManualControl(0.5, 0.0)
