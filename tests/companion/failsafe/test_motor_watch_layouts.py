"""The motor watch by the drive: one motor, two motors and a rudder, speed controllers."""

import math

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, decode_config
from companion.core.readings import BatteryReading
from companion.core.state import NavState
from companion.failsafe.motors.hypotheses import HYPOTHESES, Fault
from companion.failsafe.motors.watch import MotorWatch

pytestmark = pytest.mark.slow

STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)
DT = 0.1


def config(layout: str = "differential", driver: str = "l298n") -> BoatConfig:
    return decode_config({"drive": {"layout": layout}, "parts": {"motors": {"driver": driver}}}, "test")


def evidence(
    setting: BoatConfig, *, moment: float = 0.0, is_rudder: bool = False, ampere: float | None = None
) -> MotorWatch:
    """Half a minute at cruise speed. A moment, in shares of full steering, swings the boat from side to side;
    is_rudder: it is that of the rudder. Nomoto's first order: 0.65 rad/s at full steering within 1.25 s.
    """
    watch, rate = MotorWatch(setting), 0.0
    for tick in range(300):
        pushed = math.copysign(moment, math.sin(0.2 * tick))
        nav = replace(STILL, time_s=tick * DT, surge_m_s=2.0, yaw_rate_rad_s=rate)
        battery = None if ampere is None else BatteryReading(tick * DT, 12.0, ampere + 1e-3 * tick)
        rudder = pushed if is_rudder else 0.0
        watch.update(0.6, 0.6, nav, None, battery, setting, tick * DT, DT, rudder)
        rate += DT * 0.8 * (0.65 * pushed - rate)
    return watch


def test_one_motor_is_not_judged_against_another() -> None:
    watch = evidence(config("rudder"), moment=0.9)
    assert watch.verdict is None
    assert max(watch._evidence.against) == 0.0


def test_a_turn_by_the_rudder_is_no_evidence_against_the_motors() -> None:
    both = config("differential_rudder")
    unknown, known = evidence(both, moment=0.9), evidence(both, moment=0.9, is_rudder=True)
    dead = [at for at, one in enumerate(HYPOTHESES) if one.fault is Fault.DEAD]
    assert max(known._evidence.against[at] for at in dead) < max(unknown._evidence.against[at] for at in dead)
    assert known.verdict is None


@pytest.mark.parametrize(("driver", "has_current"), [("l298n", True), ("esc", False)])
def test_the_current_of_a_speed_controller_tells_nothing(driver: str, has_current: bool) -> None:
    watch = evidence(config(driver=driver), ampere=3.0)
    assert watch._evidence.has_current is has_current
    assert watch._evidence.knows_current is has_current
