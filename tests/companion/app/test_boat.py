import logging

import pytest
from boat_rig import OK, Rig

from companion.core.errors import SilentOutputsError
from companion.core.requests import Arm
from companion.failsafe.table import Condition
from companion.mavlink.dialect import dialect


class Recorded:
    """Motors that remember every write."""

    def __init__(self) -> None:
        self.history: list[tuple[float, float]] = []
        self.closed = 0

    def write(self, left: float, right: float) -> None:
        """Remember."""
        self.history.append((left, right))

    def stop(self) -> None:
        """Remember."""
        self.history.append((0.0, 0.0))

    def close(self) -> None:
        """Count."""
        self.stop()
        self.closed += 1


def driving(rig: Rig) -> None:
    """Armed, in MANUAL, half ahead."""
    rig.ready()
    assert rig.set_mode(0) == OK
    assert rig.arm() == OK
    for _ in range(10):
        rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, 0, 500, 0, 0))
        rig.step(5)


def test_a_disarm_between_two_ticks_stops_the_motors_at_once() -> None:
    motors = Recorded()
    rig = Rig(motors=motors)
    driving(rig)
    writes = len(motors.history)
    rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0)
    assert motors.history[writes:] == [(0.0, 0.0)]
    rig.run(1.0)
    assert set(motors.history[writes:]) == {(0.0, 0.0)}


def test_failsafes_wait_for_a_second_and_a_half_after_a_leap_of_the_clock() -> None:
    rig = Rig()
    rig.peer.heartbeat()
    rig.run(1.0)
    began_s, lost = rig.now_s + 8.0, []
    for tick in range(100):
        rig.boat.step(began_s + 0.02 * tick)
        lost.append(rig.boat.vehicle.failsafes.is_active(Condition.OPERATOR_LOST))
    assert 0.02 * lost.index(True) == pytest.approx(1.5, abs=0.05)


@pytest.mark.parametrize(("pause_s", "is_told"), [(0.98, False), (1.04, True)])
def test_a_tick_that_comes_more_than_a_second_late_is_told(pause_s: float, *, is_told: bool) -> None:
    rig = Rig()
    rig.run(1.0)
    rig.boat.step(rig.now_s + pause_s)
    assert any(text.startswith("Clock leapt by") for text in rig.peer.texts) is is_told


class Silent(Recorded):
    """Motors whose outputs may stop answering."""

    answers = True

    def write(self, left: float, right: float) -> None:
        """As long as they answer."""
        if not self.answers:
            raise SilentOutputsError("PCA9685: no answer", are_off=False)
        super().write(left, right)


def test_a_boat_whose_outputs_are_silent_arms_in_no_tick_until_they_have_answered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    motors = Silent()
    rig = Rig(motors=motors)
    rig.ready()
    boat, outcomes = rig.boat, []
    logging.getLogger("companion.autopilot.motor_output").disabled = True
    receive = boat._receive

    def arming(*args: object, **options: bool) -> int:
        outcomes.append(boat.vehicle.request(Arm()).accepted)
        boat.vehicle.disarm("")
        return receive(*args, **options)  # type: ignore[arg-type]

    motors.answers = False
    rig.step(1)
    monkeypatch.setattr(boat, "_receive", arming)
    rig.step(20)
    assert outcomes == [False] * 20
    motors.answers = True
    rig.step(10)
    assert outcomes[-1]
    logging.getLogger("companion.autopilot.motor_output").disabled = False
