"""Motors and rudder as the boat's tick writes them."""

from companion.autopilot.motor_output import MotorOutput
from companion.config.actuators import Thrusters
from companion.core.state import HEALTHY_MOTORS, STOPPED, MotorCommand
from companion.hal.interfaces import Hardware


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


def test_a_command_reaches_motors_and_rudder() -> None:
    log, hardware = _boat()
    output = MotorOutput(hardware)
    output.write(MotorCommand(0.5, 0.5, rudder=-0.25), HEALTHY_MOTORS, Thrusters())
    assert log == ["motors 0.5 0.5", "rudder -0.25"]


def test_a_stop_cuts_the_motors_first_then_centres_the_rudder() -> None:
    log, hardware = _boat()
    output = MotorOutput(hardware)
    output.write(MotorCommand(0.5, 0.5, rudder=-0.25), HEALTHY_MOTORS, Thrusters())
    output.stop()
    assert log[2:] == ["motors stop", "rudder 0"]
    assert output.command == STOPPED
