import dataclasses
import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from companion.core.geo import LatLon, Point
from companion.mavlink.dialect import dialect
from companion.mavlink.items import ItemFault, MissionItem, MissionResult
from companion.services.missions.items import IGNORED, check_jumps, to_step
from companion.vehicle.mission.steps import (
    AfterDelay,
    EnableFence,
    GoRound,
    HandOver,
    Home,
    Jump,
    LimitHandOver,
    MoveHome,
    Offset,
    ReturnHome,
    SetSpeed,
    Skip,
    Step,
    Turn,
    Wait,
    Waypoint,
    WithinDistance,
)

HERE = LatLon(50.0, -1.2)
NAN, INF = math.nan, math.inf


def item(command: int, p1: float = 0.0, p2: float = 0.0, **fields: float) -> MissionItem:
    values = {"frame": 3, "x": 500_000_000, "y": -12_000_000, "param4": NAN, "z": 50.0, **fields}
    return MissionItem(command=command, param1=p1, param2=p2, **values)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("given", "step"),
    [
        (item(dialect.MAV_CMD_NAV_WAYPOINT), Waypoint(HERE)),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, p1=5.0, p2=3.0), Waypoint(HERE, 5.0, 3.0)),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, p1=NAN, p2=NAN), Waypoint(HERE)),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, p2=INF), Waypoint(HERE)),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, p2=-1.0), Waypoint(HERE)),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, frame=1, x=125_000, y=-45_000), Waypoint(Point(12.5, -4.5))),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, frame=7, x=125_000, y=-45_000), Waypoint(Offset(12.5, -4.5))),
        (item(dialect.MAV_CMD_NAV_LOITER_UNLIM, p1=7.0), Waypoint(HERE, INF)),
        (item(dialect.MAV_CMD_NAV_LOITER_TIME, p1=30.0, p2=9.0), Waypoint(HERE, 30.0)),
        (item(dialect.MAV_CMD_NAV_LOITER_TIME, p1=NAN), Waypoint(HERE)),
        (item(dialect.MAV_CMD_NAV_LOITER_TURNS, p1=2.0, param3=15.0), GoRound(HERE, 2.0, 15.0)),
        (item(dialect.MAV_CMD_NAV_LOITER_TURNS, p1=0.5, param3=-15.0), GoRound(HERE, 0.5, 15.0, False)),
        (item(dialect.MAV_CMD_NAV_LOITER_TURNS, p1=2.0, param3=NAN), GoRound(HERE, 2.0)),
        (item(dialect.MAV_CMD_NAV_GUIDED_ENABLE, p1=0.75), HandOver(True)),
        (item(dialect.MAV_CMD_NAV_GUIDED_ENABLE), HandOver(False)),
        (item(dialect.MAV_CMD_CONDITION_DELAY, p1=3.5), AfterDelay(3.5)),
        (item(dialect.MAV_CMD_CONDITION_DISTANCE), WithinDistance(0.0)),
        (item(dialect.MAV_CMD_CONDITION_YAW, p1=90.0, param3=-1.0, param4=1.0), Turn(-0.5 * math.pi, True)),
        (item(dialect.MAV_CMD_CONDITION_YAW, p1=90.0, param3=0.0, param4=1.0), Turn(0.5 * math.pi, True)),
        (item(dialect.MAV_CMD_CONDITION_YAW, p1=90.0, param3=-1.0, param4=0.0), Turn(0.5 * math.pi)),
        (item(dialect.MAV_CMD_DO_FENCE_ENABLE, p1=1.0), EnableFence(True)),
        (item(dialect.MAV_CMD_DO_FENCE_ENABLE, p1=0.0), EnableFence(False)),
        (item(dialect.MAV_CMD_DO_FENCE_ENABLE, p1=2.0), Skip()),
        (item(dialect.MAV_CMD_DO_SET_HOME, p1=1.0), MoveHome(None)),
        (item(dialect.MAV_CMD_DO_SET_HOME), MoveHome(HERE)),
        (item(dialect.MAV_CMD_DO_GUIDED_LIMITS, p1=60.0, param4=25.0), LimitHandOver(60.0, 25.0)),
        (item(dialect.MAV_CMD_DO_GUIDED_LIMITS, p1=NAN), LimitHandOver(0.0, 0.0)),
        (item(dialect.MAV_CMD_NAV_RETURN_TO_LAUNCH, x=0, y=0), ReturnHome()),
        (item(dialect.MAV_CMD_NAV_DELAY, p1=2.5), Wait(2.5)),
        (item(dialect.MAV_CMD_DO_CHANGE_SPEED, p1=1.0, p2=1.5), SetSpeed(1.5)),
        (item(dialect.MAV_CMD_DO_CHANGE_SPEED, p2=-1.0), SetSpeed(0.0)),
        (item(dialect.MAV_CMD_DO_JUMP, p1=1.0, p2=-1.0), Jump(1, -1)),
    ],
)
def test_an_item_becomes_its_step(given: MissionItem, step: Step) -> None:
    assert to_step(1, given) == step


@pytest.mark.parametrize(
    ("given", "result", "word"),
    [
        (item(dialect.MAV_CMD_NAV_VTOL_TAKEOFF), MissionResult.UNSUPPORTED, "command 84"),
        (item(dialect.MAV_CMD_DO_SET_SERVO), MissionResult.UNSUPPORTED, "command 183"),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, frame=8), MissionResult.UNSUPPORTED_FRAME, "frame 8"),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, x=0, y=0), MissionResult.INVALID_PARAM5_X, "0, 0"),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, x=900_000_001), MissionResult.INVALID_PARAM5_X, "latitude"),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, x=-(2**31)), MissionResult.INVALID_PARAM5_X, "latitude"),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, y=2**31 - 1), MissionResult.INVALID_PARAM6_Y, "longitude"),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, p1=-1.0), MissionResult.INVALID_PARAM1, "time -1"),
        (item(dialect.MAV_CMD_NAV_WAYPOINT, z=NAN), MissionResult.INVALID_PARAM7, "altitude nan"),
        (item(dialect.MAV_CMD_NAV_LOITER_TIME, p1=INF), MissionResult.INVALID_PARAM1, "time inf"),
        (item(dialect.MAV_CMD_NAV_LOITER_TIME, frame=8), MissionResult.UNSUPPORTED_FRAME, "frame 8"),
        (item(dialect.MAV_CMD_NAV_LOITER_UNLIM, frame=8), MissionResult.UNSUPPORTED_FRAME, "frame 8"),
        (item(dialect.MAV_CMD_NAV_LOITER_TURNS, frame=8), MissionResult.UNSUPPORTED_FRAME, "frame 8"),
        (item(dialect.MAV_CMD_NAV_LOITER_TURNS), MissionResult.INVALID_PARAM1, "number of turns"),
        (item(dialect.MAV_CMD_NAV_LOITER_TURNS, p1=1.0, param3=INF), MissionResult.INVALID_PARAM3, "radius"),
        (item(dialect.MAV_CMD_CONDITION_DELAY, p1=-1.0), MissionResult.INVALID_PARAM1, "delay -1"),
        (item(dialect.MAV_CMD_CONDITION_DISTANCE, p1=-1.0), MissionResult.INVALID_PARAM1, "distance -1"),
        (item(dialect.MAV_CMD_CONDITION_YAW, p1=NAN), MissionResult.INVALID_PARAM1, "heading nan"),
        (item(dialect.MAV_CMD_DO_FENCE_ENABLE, p1=3.0), MissionResult.INVALID_PARAM1, "3 is neither"),
        (item(dialect.MAV_CMD_DO_SET_HOME, x=0, y=0), MissionResult.INVALID_PARAM5_X, "0, 0"),
        (item(dialect.MAV_CMD_DO_GUIDED_LIMITS, p1=-1.0), MissionResult.INVALID_PARAM1, "time-out -1"),
        (item(dialect.MAV_CMD_DO_GUIDED_LIMITS, param4=-1.0), MissionResult.INVALID_PARAM4, "distance -1"),
        (item(dialect.MAV_CMD_NAV_DELAY, p1=-1.0), MissionResult.INVALID_PARAM1, "delay -1"),
        (item(dialect.MAV_CMD_NAV_DELAY, p1=NAN), MissionResult.INVALID_PARAM1, "delay nan"),
        (item(dialect.MAV_CMD_DO_CHANGE_SPEED, p2=NAN), MissionResult.INVALID_PARAM2, "speed nan"),
        (item(dialect.MAV_CMD_DO_CHANGE_SPEED, p2=INF), MissionResult.INVALID_PARAM2, "speed inf"),
        (item(dialect.MAV_CMD_DO_JUMP, p1=1.5), MissionResult.INVALID_PARAM1, "1.5"),
        (item(dialect.MAV_CMD_DO_JUMP, p1=1.0, p2=NAN), MissionResult.INVALID_PARAM2, "nan"),
    ],
)
def test_an_item_that_the_boat_cannot_do_is_refused_by_its_field(
    given: MissionItem, result: MissionResult, word: str
) -> None:
    fault = to_step(1, given)
    assert isinstance(fault, ItemFault)
    assert fault.result is result
    assert word in fault.text


def test_the_first_item_is_home_and_what_a_boat_has_no_use_for_is_skipped() -> None:
    assert to_step(0, item(dialect.MAV_CMD_NAV_WAYPOINT)) == Home()
    for command in sorted(IGNORED):
        assert to_step(1, item(command)) == Skip()


@pytest.mark.parametrize(("target", "fine"), [(0, False), (1, True), (2, True), (3, False), (-1, False)])
def test_a_jump_must_lead_to_an_item_that_can_be_sailed(target: int, fine: bool) -> None:
    fault = check_jumps([Home(), Waypoint(HERE), Jump(target, 1)])
    assert (fault is None) is fine
    if fault is not None:
        assert fault.result is MissionResult.INVALID_PARAM1
        assert f"item 2 jumps to {target}" in fault.text


floats = st.floats(width=32)
integers = st.integers(-(2**31), 2**31 - 1)


@example(1, 16, 0.0, 0.0, 0, 0)
@given(
    st.integers(0, 255), st.sampled_from([16, 17, 19, 20, 93, 177, 178]), floats, floats, integers, integers
)
def test_any_item_becomes_a_step_or_a_fault(
    frame: int, command: int, p1: float, p2: float, x: int, y: int
) -> None:
    given_item = dataclasses.replace(item(command, p1, p2), frame=frame, x=x, y=y)
    step = to_step(1, given_item)
    if isinstance(step, Waypoint):
        assert step.hold_s >= 0.0
        assert 0.0 <= step.radius_m < INF
        assert (x, y) != (0, 0) or not isinstance(step.position, LatLon)  # the origin is a local place
    elif isinstance(step, Wait):
        assert 0.0 <= step.hold_s < INF
    elif isinstance(step, SetSpeed):
        assert 0.0 <= step.speed_m_s < INF
    else:
        assert isinstance(step, ItemFault | Jump | ReturnHome)
