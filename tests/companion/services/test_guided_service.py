"""Set-points as they come over the wire: what is taken, what is refused, and in which words."""

import math

import pytest
from boat_rig import BOAT, OK, PLANNER, Rig
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.core.intent import HoldCourse, HoldHeading, HoldTurn
from companion.mavlink.dialect import Message, dialect

pytestmark = pytest.mark.slow

NAN, INF = math.nan, math.inf
ALL = 0b110111111111
POSITION, VELOCITY, YAW, RATE = ALL & ~0b111, ALL & ~0b111000, ALL & ~0x400, ALL & ~0x800


def local(mask: int, frame: int = 1, x: float = 0, y: float = 0, vx: float = 0, vy: float = 0, yaw: float = 0,
          rate: float = 0) -> Message:  # fmt: skip
    message: Message = dialect.MAVLink_set_position_target_local_ned_message(
        0, *BOAT, frame, mask, x, y, 0, vx, vy, 0, 0, 0, 0, yaw, rate
    )
    return message


def globe(mask: int, lat: int, lon: int, frame: int = 6, vx: float = 0) -> Message:
    message: Message = dialect.MAVLink_set_position_target_global_int_message(
        0, *BOAT, frame, mask, lat, lon, 0, vx, 0, 0, 0, 0, 0, 0, 0
    )
    return message


def attitude(mask: int, q: list[float] | None = None, rate: float = 0, thrust: float = 0) -> Message:
    message: Message = dialect.MAVLink_set_attitude_target_message(
        0, *BOAT, mask, q or [1, 0, 0, 0], 0, 0, rate, thrust
    )
    return message


@pytest.fixture
def rig() -> Rig:
    rig = Rig().ready()
    assert rig.set_mode(15) == OK
    return rig


def held(rig: Rig, message: Message) -> object:
    rig.peer.send(message)
    rig.receive()
    set_point = rig.boat.vehicle.modes.guided.set_point
    return None if set_point is None else set_point.hold


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (local(VELOCITY, vx=0.0, vy=2.0), HoldCourse(math.pi / 2, 2.0)),
        (local(VELOCITY), HoldTurn(0.0, 0.0)),
        (local(VELOCITY & YAW, vx=1.0, yaw=0.0), HoldHeading(0.0, 1.0)),
        (local(VELOCITY & YAW, vx=1.0, yaw=math.pi / 2), HoldHeading(math.pi / 2, 0.0)),
        (local(VELOCITY & RATE, vx=1.0, rate=0.2), HoldTurn(0.2, 1.0)),
        (local(YAW, yaw=1.0), HoldHeading(1.0, 0.0)),
        (local(RATE, rate=-0.2), HoldTurn(-0.2, 0.0)),
        (local(VELOCITY, frame=8, vx=-1.0), HoldTurn(0.0, -1.0)),
        (attitude(0b00000111, [math.cos(0.5), 0, 0, math.sin(0.5)], thrust=0.0), HoldHeading(1.0, 0.0)),
        (attitude(0b10000011, rate=0.25), HoldTurn(0.25, 0.0)),
    ],
)
def test_a_set_point_is_held(rig: Rig, message: Message, expected: object) -> None:
    hold = held(rig, message)
    assert type(hold) is type(expected)
    for name in expected.__struct_fields__:  # type: ignore[attr-defined]
        assert getattr(hold, name) == pytest.approx(getattr(expected, name), abs=1e-6)


@pytest.mark.parametrize(
    ("message", "words"),
    [
        (local(VELOCITY, vx=NAN), "not a number"),
        (local(YAW, yaw=INF), "not a number"),
        (local(ALL), "neither position"),
        (local(POSITION, x=NAN), "out of range"),
        (local(POSITION, x=1e6), "out of range"),
        (local(VELOCITY & ~0b111000000), "accelerations"),
        (local(VELOCITY & ~0b111000000 | 0x200), "accelerations"),
        (local(VELOCITY, frame=3), "frame 3"),
        (globe(POSITION, 0, 0), "out of range"),
        (globe(POSITION, 910_000_000, 0), "out of range"),
        (globe(POSITION & VELOCITY, 500_000_000, -12_000_000, vx=NAN), "out of range"),
        (globe(POSITION, 500_000_000, 0, frame=1), "frame 1"),
        (attitude(0b00000111, [0, 0, 0, 0]), "out of range"),
        (attitude(0b00000111, [NAN, 0, 0, 0]), "out of range"),
        (attitude(0b10000011, rate=INF), "out of range"),
        (attitude(0b00000111, thrust=1.5), "out of range"),
    ],
)
def test_what_cannot_be_held_is_refused_in_words(rig: Rig, message: Message, words: str) -> None:
    rig.peer.forget()
    assert held(rig, message) is None
    assert rig.boat.vehicle.modes.guided.target is None
    (text,) = [text for text in rig.peer.texts if "ignored" in text]
    assert text.startswith("Set-point of 255/190 ignored: ")
    assert words in text
    assert rig.boat.endpoint.faults == 0


# As thousands of programs write it: use position or velocity, ignore all else, FORCE_SET included
ONLY_POSITION, ONLY_VELOCITY = 0b0000111111111000, 0b0000111111000111


def test_the_usual_masks_are_obeyed_although_they_name_a_force_that_is_ignored(rig: Rig) -> None:
    hold = held(rig, local(ONLY_VELOCITY, vx=0.0, vy=2.0))
    assert isinstance(hold, HoldCourse)
    assert hold.speed_m_s == 2.0
    held(rig, local(ONLY_POSITION, x=5.0))
    assert rig.boat.vehicle.modes.guided.target is not None
    held(rig, globe(ONLY_POSITION, 500_010_000, -12_000_000))
    assert rig.boat.vehicle.modes.guided.target.lat_deg == pytest.approx(50.001)
    assert [text for text in rig.peer.texts if "ignored" in text] == []


def test_each_reason_is_told_once_in_half_a_minute_whatever_comes_between(rig: Rig) -> None:
    rig.peer.forget()
    for _ in range(20):
        held(rig, local(VELOCITY, vx=NAN))
        held(rig, local(VELOCITY, frame=3))
        held(rig, local(VELOCITY, vx=1.0))  # which is obeyed
        rig.step()
    told = [text.rpartition(": ")[2] for text in rig.peer.texts if "ignored" in text]
    assert told == ["neither position nor velocity nor yaw, or not a number", "frame 3 is not supported"]
    rig.run(30.0)
    held(rig, local(VELOCITY, frame=3))
    assert len([text for text in rig.peer.texts if "frame 3" in text]) == 2


def test_reasons_that_a_hostile_station_invents_are_bounded(rig: Rig) -> None:
    rig.peer.forget()
    for frame in range(20, 200):
        held(rig, local(VELOCITY, frame=frame))
        rig.step(2)
    assert len([text for text in rig.peer.texts if "ignored" in text]) == 20


def test_a_position_is_a_target_and_its_velocity_the_speed(rig: Rig) -> None:
    held(rig, globe(POSITION & VELOCITY, 500_010_000, -12_000_000, vx=1.25))
    target = rig.boat.vehicle.modes.guided.target
    assert target is not None
    assert target.lat_deg == pytest.approx(50.001)
    assert rig.boat.vehicle.speed_m_s == 1.25


def test_a_planner_that_sets_the_course_is_missed_and_one_that_reads_is_not(rig: Rig) -> None:
    planner, watched = rig.connect(PLANNER), rig.boat.vehicle.failsafes.planner
    planner.heartbeat(dialect.MAV_TYPE_ONBOARD_CONTROLLER)
    planner.send(dialect.MAVLink_param_request_list_message(*BOAT))
    planner.command(dialect.MAV_CMD_REQUEST_MESSAGE, 148)
    rig.receive()
    assert not watched.is_steering
    planner.send(local(VELOCITY, vx=1.0))
    rig.receive()
    assert watched.is_steering


floats = st.floats(width=32)


@settings(max_examples=15)
@given(st.integers(0, 0xFFFF), st.integers(0, 255), floats, floats, floats, floats, floats, floats)
def test_any_set_point_leaves_the_boat_running(
    mask: int, frame: int, x: float, y: float, vx: float, vy: float, yaw: float, rate: float
) -> None:
    rig = Rig().ready()
    rig.set_mode(15)
    rig.arm()
    held(rig, local(mask, frame, x, y, vx, vy, yaw, rate))
    rig.step(3)
    assert rig.boat.endpoint.faults == 0
    assert math.isfinite(rig.boat.command.left + rig.boat.command.right)
