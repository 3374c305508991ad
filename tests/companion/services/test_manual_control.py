import pytest
from boat_rig import BOAT, FAILED, OK, PLANNER, Rig, waypoint

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
    [(0, 1000, 1.0, 0.0), (-1000, 0, 0.0, -1.0), (500, -250, -0.25, 0.5), (1000, -1000, -1.0, 1.0)],
)
def test_y_steers_and_z_is_the_throttle(rig: Rig, y: int, z: int, throttle: float, steering: float) -> None:
    rig.peer.send(sticks(y, z))
    assert taken(rig) == ManualControl(throttle, steering)


@pytest.mark.parametrize(("y", "z", "command"), [(INVALID, 500, (0.5, 0.5)), (400, INVALID, (0.4, -0.4))])
def test_one_invalid_axis_leaves_the_other_in_use(
    rig: Rig, y: int, z: int, command: tuple[float, float]
) -> None:
    for _ in range(20):
        rig.peer.send(sticks(y, z))
        rig.run(0.1)
    assert (rig.boat.command.left, rig.boat.command.right) == pytest.approx(command)
    assert not any("RC lost" in text for text in rig.peer.texts)


@pytest.mark.parametrize(
    ("steering_us", "throttle_us", "expected"),
    [
        (1500, 2000, ManualControl(1.0, 0.0)),
        (1000, 1500, ManualControl(0.0, -1.0)),
        (1750, 1250, ManualControl(-0.5, 0.5)),
        (900, 2100, ManualControl(1.0, -1.0)),
    ],
)
def test_rc_override_is_read_around_the_centre(
    rig: Rig, steering_us: int, throttle_us: int, expected: ManualControl
) -> None:
    rig.peer.send(override(steering_us, throttle_us))
    assert taken(rig) == expected


@pytest.mark.parametrize(
    "broken",
    [
        *[override(1500, us) for us in (1, 909, 2101, 0xFFFE)],
        *[override(us, 1500) for us in (899, 2101)],
        *[sticks(y, z) for y, z in ((0, 1001), (-1001, 0), (INVALID, 32000))],
    ],
    ids=str,
)
def test_a_value_that_is_no_command_stops_the_boat_at_once(rig: Rig, broken: Message) -> None:
    for _ in range(5):
        rig.peer.send(override(1500, 1900))
        rig.run(0.1)
    assert rig.boat.command.left == pytest.approx(0.8)
    rig.peer.send(broken)
    rig.run(0.4)
    assert (rig.boat.command.left, rig.boat.command.right) == (0.0, 0.0)


def test_values_that_are_no_commands_are_followed_by_the_failsafe(rig: Rig) -> None:
    rig.peer.send(override(1500, 1900))
    for _ in range(25):
        rig.run(0.1)
        rig.peer.send(override(1500, 3000))
    assert "Failsafe: RC lost: no stick input" in rig.peer.texts
    assert rig.mode == "LOITER"


@pytest.mark.parametrize(
    ("mode", "message", "why"),
    [
        (0, override(1531, 1500), "steering (RC1)"),
        (4, override(1500, 1469), "throttle (RC3)"),
        (10, override(1500, 1900), "throttle (RC3)"),
        (15, sticks(-800, 0), "steering (RC1)"),
        (0, sticks(INVALID, -61), "throttle (RC3)"),
    ],
    ids=str,
)
def test_the_boat_does_not_arm_while_a_station_holds_a_stick(mode: int, message: Message, why: str) -> None:
    """ArduRover answers FAILED in every mode while RC3 is off neutral, whoever holds it."""
    rig = Rig().ready()
    rig.upload([waypoint(0.0, 0.0), waypoint(50.0, 0.0)])
    assert rig.set_mode(mode) == OK
    rig.peer.send(message)
    assert rig.arm() == FAILED
    assert f"Arm: RC: {why} is not neutral" in rig.peer.texts
    for _ in range(10):
        rig.peer.send(message)
        rig.run(0.1)
    assert (rig.boat.command.left, rig.boat.command.right) == (0.0, 0.0)


# Switches and further channels


def channels(**pulses_us: int) -> Message:
    """An override of these channels alone, by number: c5=2000."""
    ignored = [KEEP] * 8 + [0] * 10
    for name, pulse_us in pulses_us.items():
        ignored[int(name[1:]) - 1] = pulse_us
    message: Message = dialect.MAVLink_rc_channels_override_message(*BOAT, *ignored)
    return message


def hold(rig: Rig, seconds: float = 0.5, **pulses_us: int) -> None:
    for _ in range(round(seconds / 0.1)):
        rig.peer.send(channels(**pulses_us))
        rig.run(0.1)


@pytest.mark.parametrize(("mode", "arm"), [(5, 6), (8, 7), (9, 10), (17, 18)])
def test_the_mode_and_arming_switches_work_on_every_channel_of_an_override(mode: int, arm: int) -> None:
    rig = Rig(config={"rc.mode_channel": mode, "rc.arm_channel": arm}).ready()
    hold(rig, **{f"c{mode}": 1100, f"c{arm}": 1000})
    assert (rig.mode, rig.boat.vehicle.armed) == ("MANUAL", False)
    hold(rig, **{f"c{mode}": 1100, f"c{arm}": 2000})
    assert (rig.mode, rig.boat.vehicle.armed) == ("MANUAL", True)
    hold(rig, **{f"c{mode}": 1425, f"c{arm}": 2000})
    assert rig.mode == "LOITER"
    hold(rig, **{f"c{mode}": 1425, f"c{arm}": 1000})
    assert not rig.boat.vehicle.armed
    assert "Disarmed by the arming switch" in rig.peer.texts


@pytest.mark.parametrize("pause_s", [1.5, 0.0])
def test_an_override_that_comes_or_comes_back_with_the_switch_up_does_not_arm(pause_s: float) -> None:
    rig = Rig(config={"rc.arm_channel": 6}).ready()
    if pause_s:
        hold(rig, c6=1000)
        rig.run(pause_s)
    hold(rig, 2.0, c6=2000)
    assert not rig.boat.vehicle.armed
    hold(rig, c6=1000)
    hold(rig, c6=2000)
    assert rig.boat.vehicle.armed


def test_channels_show_what_is_overridden_by_the_rules_of_the_message() -> None:
    """0 gives channels 1 to 8 back and is ignored from 9 on, where 65534 gives back; 65535 is ignored."""
    rig = Rig(config={"rc.channel_3.max_us": 1900, "rc.channel_3.min_us": 1100}).ready()

    def shown(**pulses_us: int) -> dict[int, int]:
        hold(rig, 0.2, **pulses_us)
        rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_RC_CHANNELS)
        message = rig.peer.said("RC_CHANNELS")[-1]
        pulses = [getattr(message, f"chan{number}_raw") for number in range(1, 19)]
        assert message.chancount == max(number for number, us in enumerate(pulses, 1) if us != KEEP)
        return {number: us for number, us in enumerate(pulses, 1) if us not in (KEEP, 1500)}

    assert shown(c1=1500, c2=1700, c3=1850, c5=1111, c9=1999, c18=1000) == {
        2: 1700, 3: 1850, 5: 1111, 9: 1999, 18: 1000,
    }  # fmt: skip
    assert shown(c1=1500, c3=1850, c2=RELEASE, c5=KEEP, c9=0xFFFE, c18=0) == {3: 1850, 5: 1111, 18: 1000}
    assert shown(c5=500, c6=2101, c7=0xFFFE, c9=1200) == {3: 1850, 5: 1111, 9: 1200, 18: 1000}
    hold(rig, 0.4, c9=1200)
    assert shown(c9=1200) == {3: 1850, 9: 1200}  # each channel has its own lifetime
    rig.run(3.0)
    assert shown() == {}


def test_a_released_axis_is_centred_and_an_ignored_one_keeps_its_value(rig: Rig) -> None:
    rig.peer.send(override(1600, 1800))
    rig.peer.send(override(KEEP, 1900))
    assert taken(rig) == ManualControl(0.8, 0.2)
    rig.peer.send(override(1500, KEEP))
    assert taken(rig) == ManualControl(0.8, 0.0)
    rig.peer.send(override(1500, RELEASE))
    assert taken(rig) == ManualControl(0.0, 0.0)


def test_only_the_chosen_operator_has_his_hand_on_the_boat() -> None:
    rig = Rig(config={"identity.operator_system_id": 255}).ready()
    planner = rig.connect(PLANNER)
    planner.send(sticks(0, 1000))
    planner.send(override(1500, 2000))
    assert taken(rig) == ManualControl(0.0, 0.0)
    rig.peer.send(sticks(0, 500))
    assert taken(rig) == ManualControl(0.5, 0.0)


def test_the_helm_is_free_when_its_stations_link_has_closed(rig: Rig) -> None:
    other = rig.connect(PLANNER)
    rig.peer.send(sticks(0, 500))
    assert taken(rig) == ManualControl(0.5, 0.0)
    other.send(sticks(0, -500))
    assert taken(rig) == ManualControl(0.5, 0.0)
    assert "Helm: 255/190 has it, your sticks are ignored" in other.texts
    rig.peer.link.close()
    rig.receive()
    other.send(sticks(0, -500))
    assert taken(rig) == ManualControl(-0.5, 0.0)


def test_the_first_hand_has_the_helm_until_it_is_stale_and_the_second_is_told_once(rig: Rig) -> None:
    other = rig.connect(PLANNER)
    for _ in range(10):
        rig.peer.send(sticks(0, 500))
        other.send(sticks(0, -500))
        assert taken(rig) == ManualControl(0.5, 0.0)
        rig.run(0.2)
    assert [text for text in other.texts if "Helm" in text] == [
        "Helm: 255/190 has it, your sticks are ignored"
    ]
    assert not any("Helm" in text for text in rig.peer.texts)
    rig.run(rig.config.failsafe.manual_timeout_s + 0.1)
    other.send(sticks(0, -500))
    assert taken(rig) == ManualControl(-0.5, 0.0)
    for peer in (rig.peer, other):
        assert f"Helm: {PLANNER.system}/{PLANNER.component} took over from 255/190" in peer.texts


def test_an_override_released_lets_go_at_once(rig: Rig) -> None:
    other = rig.connect(PLANNER)
    rig.peer.send(override(1500, 1800))
    rig.peer.send(override(RELEASE, RELEASE))
    rig.receive()
    other.send(sticks(0, 300))
    assert taken(rig).throttle == 0.3
