import logging
from collections.abc import Iterator

import pytest
from boat_rig import OK, Rig, waypoint

from companion.autopilot.motor_output import MotorOutput
from companion.config.actuators import Thrusters
from companion.core.errors import HardwareError
from companion.core.intent import Intent
from companion.core.state import HEALTHY_MOTORS, STOPPED, MotorCommand
from companion.hal.interfaces import Hardware


@pytest.fixture(autouse=True)
def quiet() -> Iterator[None]:
    """The faults of these tests are meant."""
    logging.getLogger("companion.autopilot.motor_output").disabled = True
    yield
    logging.getLogger("companion.autopilot.motor_output").disabled = False


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


class _Recorder:
    def __init__(self, log: list[str], name: str) -> None:
        self._log, self._name = log, name

    def write(self, *shares: float) -> None:
        self._log.append(f"{self._name} {' '.join(f'{share:g}' for share in shares)}")

    def stop(self) -> None:
        self._log.append(f"{self._name} stop")

    def close(self) -> None:
        self._log.append(f"{self._name} close")

    def read(self) -> None:
        """No reading."""


def _boat() -> tuple[list[str], Hardware]:
    log: list[str] = []
    sensor = _Recorder(log, "sensor")
    return log, Hardware(_Recorder(log, "motors"), sensor, sensor, rudder=_Recorder(log, "rudder"))


def test_a_stop_cuts_the_motors_first_then_centres_the_rudder() -> None:
    log, hardware = _boat()
    output = MotorOutput(hardware)
    output.write(MotorCommand(0.5, 0.5, rudder=-0.25), HEALTHY_MOTORS, Thrusters())
    output.stop()
    assert log[2:] == ["motors stop", "rudder 0"]
    assert output.command == STOPPED
