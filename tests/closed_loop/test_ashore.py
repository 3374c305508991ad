"""Close to the shore: motors tried where the fence would brake them, and a boat that lies on it."""

from boat_rig import OK, Rig
from fence_rig import box, fenced, margin_m, polygon
from sailing_rig import armed, begin, told

from companion.boat import TICK_S
from companion.core.modes import Mode
from companion.core.state import MotorState, MotorStates
from companion.failsafe.actions import Trigger
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionType
from sitl.courses.missions import fence_along, plan_mission, wire_items

AGROUND = "Failsafe: Aground: held at the shore"


def test_a_dead_motor_is_found_out_between_lines_that_brake_the_boat() -> None:
    rig = armed(Mode.LOITER, rig=fenced(Rig().ready(), *polygon(box(-3.0, -3.0, 3.0, 3.0))))
    begin(rig, "motor_right", "stuck")
    recovery = rig.boat.vehicle.recovery
    recovery.handle(Trigger.CHECK, rig.now_s)
    rig.until(lambda: not recovery.is_checking, 10.0)
    assert recovery.motor_check.motors == MotorStates(right=MotorState.FAILED)
    assert margin_m(rig) > 0.5


def pressed(seed: int) -> Rig:
    """Without power, the water has set the boat onto the shore; the power has just come back."""
    config: dict[str, object] = {"failsafe.resume": 2, "failsafe.aground_action": 9}
    rig = Rig("random", f"seed={seed}", "environment.current_m_s=0.8", config=config).ready()
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


def test_a_boat_pressed_against_the_shore_gets_off_and_goes_on_with_its_mission() -> None:
    rig = pressed(5009)  # from 5005 the boat backs off by itself before it is called aground
    told(rig, "Failsafe over: afloat again", 60.0)
    assert AGROUND in rig.peer.texts
    assert margin_m(rig) > 1.0
    assert not any("gives no thrust" in text for text in rig.peer.texts)
    assert rig.boat.vehicle.failsafes.fence.breaches, "its position was outside meanwhile"
    assert not any(text.startswith("Failsafe: Outside the fence") for text in rig.peer.texts)
    at = rig.world.truth
    rig.until(lambda: rig.offset_m(at.north_m, at.east_m) > 10.0, 60.0)
    assert rig.mode == "AUTO"


def test_one_that_cannot_get_off_rests_its_motors_between_tries_until_hold_ends_the_trying() -> None:
    rig = pressed(5007)
    thrust, began_s = 0.0, rig.now_s
    while "Aground: motors rest before the next try" not in rig.peer.texts or rig.now_s - began_s < 60.0:
        thrust += thrust_s(rig, 5.0)
        assert rig.now_s - began_s < 150.0
    assert thrust < 0.5 * (rig.now_s - began_s)
    assert AGROUND in rig.peer.texts
    assert rig.set_mode(Mode.HOLD) == OK
    rig.run(1.0)
    assert thrust_s(rig, 10.0) == 0.0
