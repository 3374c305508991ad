"""The rudder watch: what proves a rudder or a motor useless, and what does not."""

import math

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, decode_config
from companion.core.state import NavState
from companion.failsafe.motors.rudder_watch import RudderWatch

HELPLESS, REVERSED = "Steering lost: rudder or motor has no effect", "Steering lost: motor reversed"
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)
DT = 0.1


def config(layout: str = "rudder") -> BoatConfig:
    return decode_config(
        {"drive": {"layout": layout, "wash": 0.5}, "speed": {"cruise_m_s": 1.0, "cruise_throttle": 0.5}},
        "test",
    )


def fault_after(
    seconds: float,
    *,
    rudder: float = 1.0,
    throttle: float = 0.5,
    surge_m_s: float = 1.0,
    turn_rad_s: float = 0.0,
    layout: str = "rudder",
    watch: RudderWatch | None = None,
) -> str:
    watch, nav = watch or RudderWatch(), replace(STILL, surge_m_s=surge_m_s, yaw_rate_rad_s=turn_rad_s)
    for _ in range(round(seconds / DT)):
        watch.update(throttle, rudder, nav, config(layout), DT)
    return watch.fault


# One second of smoothing delays each judgement by one to two.
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_hard_over_in_vain_is_a_fault_after_seconds(side: float) -> None:
    assert fault_after(3.0, rudder=side) == ""
    assert fault_after(6.0, rudder=side) == HELPLESS


def test_a_slow_boat_is_given_more_time() -> None:
    # A tenth of full steering: ten times as long as full steering
    slow = {"throttle": 0.1, "surge_m_s": 0.4}
    assert fault_after(20.0, **slow) == ""  # type: ignore[arg-type]
    assert fault_after(35.0, **slow) == HELPLESS  # type: ignore[arg-type]


def test_a_turn_clears_the_fault_and_a_pause_does_not() -> None:
    watch = RudderWatch()
    assert fault_after(6.0, watch=watch) == HELPLESS
    watch.pause()
    assert watch.fault == HELPLESS
    assert fault_after(4.0, turn_rad_s=0.3, watch=watch) == ""
    assert fault_after(6.0, watch=watch) == HELPLESS
    watch.rearm()
    assert watch.fault == ""


def test_going_astern_under_throttle_ahead_is_a_reversed_motor() -> None:
    assert fault_after(4.0, rudder=0.0, surge_m_s=-0.2) == ""
    assert fault_after(6.0, rudder=0.0, surge_m_s=-0.2) == REVERSED
    assert fault_after(60.0, rudder=0.0, surge_m_s=-0.1) == ""
    assert fault_after(60.0, rudder=0.0, surge_m_s=-0.2, throttle=0.25) == ""
    assert fault_after(60.0, rudder=0.0, surge_m_s=-0.2, layout="differential_rudder") == ""


def test_without_a_rudder_or_an_estimate_nothing_is_judged() -> None:
    assert fault_after(60.0, layout="differential") == ""
    watch = RudderWatch()
    watch.update(0.5, 1.0, None, config(), DT)
    assert watch.fault == ""
    assert not math.isnan(watch._steered)
