"""Close to the shore: motors tried where the fence would brake them, and a boat that lies on it."""

import pytest
from boat_rig import OK, Rig
from fence_rig import box, fenced, margin_m, polygon

from companion.boat import TICK_S
from companion.core.state import MotorState, MotorStates
from companion.failsafe.recovery.transition_table import Trigger
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionType
from sitl.courses.missions import fence_along, plan_mission, wire_items
from sitl.world.faults.catalogue import FaultSetting

AGROUND = "Failsafe: Aground: held at the shore"


@pytest.mark.parametrize(("what", "kind"), [("motor_left", "off"), ("motor_right", "stuck")])
def test_a_dead_motor_is_found_out_between_lines_that_brake_the_boat(what: str, kind: str) -> None:
    rig = Rig().ready()
    fenced(rig, *polygon(box(-3.0, -3.0, 3.0, 3.0)))
    assert rig.set_mode(5) == OK
    assert rig.arm() == OK
    rig.world.electronics.faults.begin(FaultSetting(what=what, kind=kind))
    recovery = rig.boat.vehicle.recovery
    recovery.handle(Trigger.CHECK, rig.now_s)
    rig.until(lambda: not recovery.is_checking, 10.0)
    failed = MotorState.FAILED
    assert recovery.motor_check.motors == (
        MotorStates(left=failed) if what == "motor_left" else MotorStates(right=failed)
    )
    assert margin_m(rig) > 0.5


def pressed(seed: int, aground_action: int = 9, **more: object) -> Rig:
    """Without power, the water has set the boat onto the shore; the power has just come back."""
    rig = Rig(
        "random",
        f"seed={seed}",
        "environment.current_m_s=0.8",
        config={"failsafe.resume": 2, "failsafe.aground_action": aground_action, **more},
    ).ready()
    rig.upload(fence_along(rig.scenario), mission_type=MissionType.FENCE)
    rig.upload(wire_items(plan_mission(rig.scenario)[0]))
    assert rig.arm() == OK
    assert rig.ask(dialect.MAV_CMD_MISSION_START) == OK
    rig.run(10.0)
    rig.world._motors.stop()
    for _ in range(20_000):
        if rig.world.truth.grounded:
            break
        rig.world.step(TICK_S)
    for _ in range(250):
        rig.world.step(TICK_S)
    rig.reboot()
    rig.until(lambda: rig.boat.vehicle.armed, 60.0)
    return rig


def thrust_s(rig: Rig, seconds: float) -> float:
    """Seconds of full thrust that so long takes."""
    total = 0.0
    for _ in range(round(seconds / 0.2)):
        rig.run(0.2)
        total += 0.1 * (abs(rig.boat.command.left) + abs(rig.boat.command.right))
    return total


def test_a_boat_pressed_against_the_shore_gets_off_and_sails_its_mission() -> None:
    rig = pressed(5009)
    rig.until(lambda: "Failsafe over: afloat again" in rig.peer.texts, 60.0)
    assert AGROUND in rig.peer.texts
    assert margin_m(rig) > 1.0
    assert not any("gives no thrust" in text for text in rig.peer.texts)
    assert rig.boat.vehicle.failsafes.fence.breaches, "its position was outside meanwhile"
    assert not any(text.startswith("Failsafe: Outside the fence") for text in rig.peer.texts)
    rig.until(lambda: rig.boat.vehicle.progress.finished, 150.0)


def test_one_that_cannot_get_off_rests_its_motors_between_tries() -> None:
    rig = pressed(5007)
    assert thrust_s(rig, 150.0) < 75.0
    assert AGROUND in rig.peer.texts
    assert "Aground: motors rest before the next try" in rig.peer.texts


def test_hold_ends_the_trying() -> None:
    rig = pressed(5007)
    rig.until(lambda: AGROUND in rig.peer.texts, 60.0)
    assert rig.set_mode(4) == OK
    rig.run(1.0)
    assert thrust_s(rig, 20.0) == 0.0
