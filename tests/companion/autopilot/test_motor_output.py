"""Motors and rudder at the end of a tick: what becomes of them after a fault, and what the operator hears."""

import pytest

from companion.autopilot.motor_output import STUCK_AGAIN_S, MotorOutput
from companion.config.actuators import Thrusters
from companion.core.errors import HardwareError, SilentOutputsError
from companion.core.state import HEALTHY_MOTORS, STOPPED, MotorCommand
from companion.hal.interfaces import Hardware

AHEAD = MotorCommand(0.5, 0.5, rudder=0.25)


pytest_plugins = ("meant_faults",)
pytestmark = pytest.mark.usefixtures("meant_faults")


class Output:
    """Motors or rudder; fault: what it raises. calls: may be shared, to see the order."""

    def __init__(self, name: str = "", calls: list[str] | None = None) -> None:
        self.fault: Exception | None = None
        self.shares: tuple[float, ...] = ()
        self._name, self._calls = name, [] if calls is None else calls

    def write(self, *shares: float) -> None:
        self._do(shares, " ".join(f"{share:g}" for share in shares))

    def stop(self) -> None:
        self._do((0.0, 0.0), "stop")

    def _do(self, shares: tuple[float, ...], what: str) -> None:
        if self.fault is not None:
            raise self.fault
        self.shares = shares
        self._calls.append(f"{self._name} {what}")

    def read(self) -> None:
        """No reading."""

    def close(self) -> None:
        """Nothing to let go."""


class Cutoff:
    trips = 0


def test_a_stop_cuts_the_motors_first_then_centres_the_rudder() -> None:
    calls: list[str] = []
    motors, rudder = Output("motors", calls), Output("rudder", calls)
    output = MotorOutput(Hardware(motors, Output(), Output(), rudder=rudder))
    output.write(MotorCommand(0.5, 0.5, rudder=-0.25), HEALTHY_MOTORS, Thrusters())
    output.stop()
    assert calls[2:] == ["motors stop", "rudder 0"]
    assert output.command == STOPPED


def test_a_fault_elsewhere_stops_both_motors_and_centres_the_rudder() -> None:
    motors, rudder = Output(), Output()
    output = MotorOutput(Hardware(motors, Output(), Output(), rudder=rudder))
    output.write(AHEAD, HEALTHY_MOTORS, Thrusters())
    assert rudder.shares == (0.25,)
    rudder.shares = (1.0,)
    assert output.stop_after_fault() == "motors off"
    assert output.command == STOPPED
    assert (motors.shares, rudder.shares, output.stuck) == ((0.0, 0.0), (0.0,), "")


def test_motors_that_do_not_stop_are_told_at_once_and_every_few_seconds_until_they_answer() -> None:
    motors = Output()
    output = MotorOutput(Hardware(motors, Output(), Output()))
    assert output.stuck_text(0.0) == ""
    motors.fault = HardwareError("PCA9685: no answer")
    assert output.stop_after_fault() == "motors do not stop: PCA9685: no answer"
    text = "Motors do not stop: switch the boat off (PCA9685: no answer)"
    assert output.stuck_text(1.0) == text
    assert output.stuck_text(1.0 + 0.9 * STUCK_AGAIN_S) == ""
    assert output.stuck_text(1.0 + STUCK_AGAIN_S) == text
    motors.fault = ValueError()
    output.stop_after_fault()
    assert output.stuck == "ValueError", "a fault without words has its kind"
    motors.fault = None
    output.write(AHEAD, HEALTHY_MOTORS, Thrusters())
    assert output.stuck_text(100.0) == ""


@pytest.mark.parametrize(("are_off", "stuck"), [(True, ""), (False, "no answer")])
def test_outputs_that_a_pin_has_switched_off_do_not_count_as_stuck(are_off: bool, stuck: str) -> None:
    motors = Output()
    output = MotorOutput(Hardware(motors, Output(), Output()))
    motors.fault = SilentOutputsError("no answer", are_off=are_off)
    output.stop_after_fault()
    assert output.stuck == stuck


def test_a_rudder_that_fails_too_does_not_hide_that_the_motors_are_off() -> None:
    motors, rudder = Output(), Output()
    rudder.fault = HardwareError("rudder: no answer")
    output = MotorOutput(Hardware(motors, Output(), Output(), rudder=rudder))
    assert output.stop_after_fault() == "motors off"
    assert motors.shares == (0.0, 0.0)


def test_each_trip_of_the_cutoff_is_told_once() -> None:
    cutoff = Cutoff()
    output = MotorOutput(Hardware(Output(), Output(), Output(), cutoff=cutoff))
    assert output.trip_text(0.5) == ""
    cutoff.trips = 1
    assert output.trip_text(0.5) == "Program stalled: motors cut off after 0.5 s"
    assert output.trip_text(0.5) == ""
    assert MotorOutput(Hardware(Output(), Output(), Output())).trip_text(0.5) == ""
