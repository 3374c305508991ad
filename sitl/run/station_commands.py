"""Commands of the lockstep's station, which wait for the boat's answer."""

from collections.abc import Callable, Sequence

from companion.core.errors import BoatError
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionType
from sitl.run.lockstep import Lockstep

BOOT_S = 60.0  # longest wait for the boat to become armable
UPLOAD_S = 60.0
ANSWER_S = 5.0


class RunError(BoatError):
    """The boat refused a command or did not reach a state in time; the message says what and why."""


class StationCommands:
    """Commands over MAVLink. step: advances the run by one tick. Every method may raise a RunError."""

    def __init__(self, lockstep: Lockstep, step: Callable[[], None]) -> None:
        self._lockstep = lockstep
        self._step = step

    def wait(self, is_so: Callable[[], bool], limit_s: float, failure: str) -> None:
        """Step until a condition holds, for at most limit_s."""
        deadline_s = self._lockstep.time_s + limit_s
        while not is_so():
            if self._lockstep.time_s > deadline_s:
                raise RunError(f"{failure} within {limit_s:g} simulated seconds")
            self._step()

    def command(self, number: int, *params: float, what: str) -> None:
        """Send a command and wait until it is accepted."""
        station = self._lockstep.station
        station.command(number, *params)
        self.wait(lambda: station.answer(number) is not None, ANSWER_S, f"{what} was not answered")
        if station.answer(number) != dialect.MAV_RESULT_ACCEPTED:
            said = station.texts[-1] if station.texts else "it did not say why"
            raise RunError(f"the boat refused {what}: {said}")

    def until_armable(self) -> None:
        """Wait until the boat reports that it may be armed and has a position, which arming does not need."""
        self.wait(self._is_armable, BOOT_S, "the boat did not become armable")

    def upload(self, items: Sequence[MissionItem], kind: MissionType = MissionType.MISSION) -> None:
        """Upload a mission, or another list."""
        station = self._lockstep.station
        station.upload(items, self._lockstep.time_s, kind)
        self.wait(lambda: station.uploaded is not None, UPLOAD_S, "the upload did not end")
        if not station.uploaded:
            raise RunError(f"the boat refused the {kind.name.lower()}: {station.refusal}")

    def arm(self) -> None:
        """Arm the motors."""
        self.command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, what="arming")

    def start_mission(self) -> None:
        """Start the mission."""
        self.command(dialect.MAV_CMD_MISSION_START, what="the start of the mission")

    def change_mode(self, number: int) -> None:
        """Enter a mode by its Rover number."""
        flag = float(dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED)
        self.command(dialect.MAV_CMD_DO_SET_MODE, flag, float(number), what=f"mode {number}")

    def _is_armable(self) -> bool:
        status = self._lockstep.station.latest.get("SYS_STATUS")
        if status is None:
            return False
        bits = dialect.MAV_SYS_STATUS_PREARM_CHECK | dialect.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
        return bool(status.onboard_control_sensors_health & bits == bits)
