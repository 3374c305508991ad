import logging

import pytest
from boat_rig import Rig

from companion.core.errors import SilentOutputsError
from companion.core.requests import Arm
from companion.core.storage import MemoryStorage
from companion.failsafe.table import Condition


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


class SilentMotors:
    """Motors whose outputs may stop answering."""

    answers = True

    def write(self, left: float, right: float) -> None:
        if not self.answers:
            raise SilentOutputsError("PCA9685: no answer", are_off=False)

    def stop(self) -> None:
        pass

    close = stop


def test_a_boat_whose_outputs_are_silent_arms_in_no_tick_until_they_have_answered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    motors = SilentMotors()
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


class Stuck(SilentMotors):
    def close(self) -> None:
        raise OSError("bus stuck")


class Kept(MemoryStorage):
    is_closed = False

    def close(self) -> None:
        self.is_closed = True


def test_motors_that_cannot_be_closed_leave_nothing_else_open() -> None:
    storage = Kept()
    rig = Rig(storage=storage, motors=Stuck())
    with pytest.raises(OSError, match="bus stuck"):
        rig.boat.close()
    assert storage.is_closed
    assert not rig.peer.link.send(b"")
