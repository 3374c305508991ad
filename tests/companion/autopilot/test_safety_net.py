import pytest
from boat_rig import OK, Rig, waypoint

from companion.core.errors import HardwareError
from companion.core.intent import Intent

pytest_plugins = ("meant_faults",)
pytestmark = pytest.mark.usefixtures("meant_faults")


class Trap:
    """Stands in for the pilot: breaks when it is set."""

    def __init__(self, rig: Rig) -> None:
        self.is_set = True
        self._rig = rig
        self._decide = rig.boat.vehicle.decide
        rig.boat.vehicle.decide = self.decide  # type: ignore[method-assign]

    def decide(self) -> Intent:
        """As the vehicle's own, or not at all."""
        if self.is_set:
            raise ZeroDivisionError
        return self._decide()


def under_way() -> Rig:
    rig = Rig().sail(waypoint(200.0, 0.0))
    rig.run(10.0)
    assert rig.boat.command.left > 0.3
    return rig


def motors(rig: Rig) -> tuple[float, float]:
    return rig.world._motors.left, rig.world._motors.right


def test_a_driver_that_fails_is_named_and_the_boat_is_on_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = under_way()
    write, failures = rig.world.hardware.motors.write, iter([True])

    def fail_once(left: float, right: float) -> None:
        if next(failures, False):
            raise HardwareError("PCA9685 channel 0: its supply dipped")
        write(left, right)

    monkeypatch.setattr(rig.world.hardware.motors, "write", fail_once)
    rig.step()
    assert "PCA9685 channel 0: its supply dipped, motors off" in rig.peer.texts
    assert (rig.mode, rig.boat.vehicle.armed) == ("HOLD", True)


def test_a_single_fault_stops_the_motors_in_the_same_tick_and_leaves_the_boat_on_hold() -> None:
    rig = under_way()
    trap = Trap(rig)
    rig.step()
    assert motors(rig) == (0.0, 0.0)
    assert "Fault in the program: ZeroDivisionError, motors off" in rig.peer.texts
    assert (rig.mode, rig.boat.vehicle.armed) == ("HOLD", True)
    trap.is_set = False
    rig.run(5.0)
    assert motors(rig) == (0.0, 0.0)
    assert rig.set_mode(10) == OK  # the operator may go on
    rig.run(5.0)
    assert rig.world.truth.surge_m_s > 1.5


def test_faults_that_do_not_end_disarm_the_boat_and_then_end_the_program() -> None:
    rig = under_way()
    Trap(rig)
    rig.step(20)
    assert not rig.boat.vehicle.armed
    assert motors(rig) == (0.0, 0.0)
    with pytest.raises(ZeroDivisionError):
        rig.step(40)
    assert motors(rig) == (0.0, 0.0)
    assert sum("motors off" in text for text in rig.peer.texts) == 2  # told, and told again when it disarms


def test_a_fault_between_two_ticks_is_caught_as_well() -> None:
    rig = under_way()

    def fail(*_: object) -> None:
        raise KeyError

    rig.boat.channels.receive = fail  # type: ignore[assignment,method-assign]
    rig.receive()
    assert motors(rig) == (0.0, 0.0)
    assert rig.mode == "HOLD"
