"""The gate at and around each of its limits."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from companion.config.tuning import MotorLimits
from companion.control.gate import Gate
from companion.core.state import MotorCommand, NavState, Thrust

SETTING = MotorLimits(slew_per_s=4.0, deadband=0.05, command_timeout_s=0.5, estimate_timeout_s=3.0)
DT = 0.02
STEP = 4.0 * DT
NAV = NavState(10.0, 1.0, 2.0, 0.3, 0.0, 0.5, 0.5, 0.7, 0.0, 0.1, 0.02)
AHEAD = Thrust(0.6, 0.6)


def _check(
    gate: Gate,
    thrust: Thrust = AHEAD,
    *,
    armed: bool = True,
    age_s: float = 0.0,
    nav: NavState | None = NAV,
    needs_estimate: bool = True,
    setting: MotorLimits = SETTING,
    dt_s: float = DT,
    nav_age_s: float = 0.0,
) -> MotorCommand:
    return gate.check(
        thrust,
        armed=armed,
        command_age_s=age_s,
        nav=nav,
        needs_estimate=needs_estimate,
        setting=setting,
        dt_s=dt_s,
        estimate_age_s=nav_age_s,
        rudder_slew_per_s=3.0,
    )


def _running() -> Gate:
    gate = Gate()
    for _ in range(20):
        command = _check(gate)
    assert command == MotorCommand(0.6, 0.6)
    return gate


@pytest.mark.parametrize(
    ("faults", "reason"),
    [
        ({"armed": False}, "disarmed"),
        ({"age_s": math.nextafter(0.5, 1.0)}, "command is stale"),
        ({"age_s": -1e-9}, "command is stale"),
        ({"age_s": math.nan}, "command is stale"),
        ({"age_s": math.inf}, "command is stale"),
        ({"thrust": Thrust(math.nan, 0.0)}, "thrust is not a number"),
        ({"thrust": Thrust(0.0, math.nan)}, "thrust is not a number"),
        ({"thrust": Thrust(math.inf, -math.inf)}, "thrust is not a number"),
        ({"nav": None}, "no estimate"),
        ({"nav_age_s": math.nextafter(0.5, 1.0)}, "estimate is stale"),
        ({"nav_age_s": -1e-9}, "estimate is stale"),
        ({"nav_age_s": math.nan}, "estimate is stale"),
        ({"nav": replace(NAV, position_age_s=math.nextafter(3.0, 4.0))}, "position is stale"),
        ({"nav": replace(NAV, position_age_s=math.inf)}, "position is stale"),
        ({"nav": replace(NAV, position_age_s=math.nan)}, "position is stale"),
        ({"nav": replace(NAV, heading_age_s=math.nextafter(3.0, 4.0))}, "heading is stale"),
        ({"nav": replace(NAV, heading_age_s=math.nan)}, "heading is stale"),
        ({"nav": replace(NAV, north_m=math.nan)}, "estimate is not a number"),
        ({"nav": replace(NAV, yaw_rate_rad_s=math.inf)}, "estimate is not a number"),
        ({"nav": replace(NAV, surge_m_s=math.nan)}, "estimate is not a number"),
    ],
)
def test_every_objection_stops_both_motors_at_once(faults: dict[str, object], reason: str) -> None:
    gate = _running()
    assert _check(gate, **faults) == MotorCommand(0.0, 0.0, reason)  # type: ignore[arg-type]
    assert _check(gate).left == pytest.approx(STEP)  # and the way back starts from zero


@pytest.mark.parametrize(
    "limits",
    [
        {"age_s": 0.5},
        {"age_s": 0.0},
        {"nav_age_s": 0.5},
        {"nav": replace(NAV, position_age_s=3.0, heading_age_s=3.0)},
        {"thrust": Thrust(1.0, -1.0)},
    ],
)
def test_exactly_at_the_limit_is_still_good(limits: dict[str, object]) -> None:
    assert _check(Gate(), **limits).reason == ""  # type: ignore[arg-type]


def test_a_reversal_stops_at_zero_for_a_tick() -> None:
    gate = _running()
    lefts = [_check(gate, Thrust(-0.6, -0.6)).left for _ in range(20)]
    assert 0.0 in lefts
    assert lefts == sorted(lefts, reverse=True)
    assert lefts[-1] == -0.6


@pytest.mark.parametrize(("wanted", "sent"), [(0.0499, 0.0), (-0.0499, 0.0), (0.05, 0.05), (-0.05, -0.05)])
def test_the_dead_band_ends_where_it_says(wanted: float, sent: float) -> None:
    gate = Gate()
    for _ in range(5):
        command = _check(gate, Thrust(wanted, -wanted))
    assert (command.left, command.right) == (sent, -sent)


@pytest.mark.parametrize("dt_s", [0.0, -1.0, math.nan])
def test_time_that_stands_still_moves_nothing(dt_s: float) -> None:
    assert _check(_running(), Thrust(1.0, 0.2), dt_s=dt_s) == MotorCommand(0.6, 0.6)
    assert _check(Gate(), dt_s=dt_s) == MotorCommand(0.0, 0.0)


anything = st.floats(allow_nan=True, allow_infinity=True)


@given(st.lists(st.tuples(anything, anything, st.booleans(), anything, anything), max_size=30))
def test_the_motors_get_valid_values_for_any_input(
    ticks: list[tuple[float, float, bool, float, float]],
) -> None:
    gate = Gate()
    before = MotorCommand(0.0, 0.0)
    for left, right, armed, age_s, position_age_s in ticks:
        nav = replace(NAV, position_age_s=position_age_s)
        now = _check(gate, Thrust(left, right), armed=armed, age_s=age_s, nav=nav)
        for was, is_now in ((before.left, now.left), (before.right, now.right)):
            assert -1.0 <= is_now <= 1.0
            assert is_now == 0.0 or abs(is_now) >= SETTING.deadband
            assert was * is_now >= 0.0
            assert abs(is_now) <= abs(was) + max(STEP, SETTING.deadband) + 1e-12
        if now.reason:
            assert (now.left, now.right) == (0.0, 0.0)
        assert bool(now.reason) or (armed and 0.0 <= age_s <= 0.5)
        before = now


def test_the_rudder_turns_at_its_own_rate_to_its_end() -> None:
    gate = Gate()
    angles = [_check(gate, Thrust(0.6, 0.6, -7.0)).rudder for _ in range(20)]
    assert angles == pytest.approx([max(-0.06 * tick, -1.0) for tick in range(1, 21)])


def test_a_stop_centres_the_rudder_and_it_starts_from_there() -> None:
    gate = Gate()
    for _ in range(30):
        _check(gate, Thrust(0.6, 0.6, 1.0))
    assert _check(gate, Thrust(0.6, 0.6, 1.0), armed=False) == MotorCommand(0.0, 0.0, "disarmed", 0.0)
    assert _check(gate, Thrust(0.6, 0.6, 1.0)).rudder == pytest.approx(0.06)
