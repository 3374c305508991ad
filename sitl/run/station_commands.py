"""Commands of the lockstep's station, which wait for the boat's answer."""

from collections.abc import Callable, Sequence

from companion.core.errors import BoatError
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem
from mission_tools.station.items import Kind
from mission_tools.station.outcome import Accepted, Answered, Outcome, Refused
from mission_tools.station.requests import BoatCommand, build_command
from sitl.run.lockstep import Lockstep

BOOT_S = 60.0  # longest wait for the boat to become armable


class RunError(BoatError):
    """The boat refused a command or did not reach a state in time; the message says what and why."""


class StationCommands:
    """Commands over MAVLink. step: advances the run by one tick. Every method may raise a RunError."""

    def __init__(self, lockstep: Lockstep, step: Callable[[], None]) -> None:
        self._lockstep = lockstep
        self._station = lockstep.station
        self._step = step

    def wait(self, is_so: Callable[[], bool], limit_s: float, failure: str) -> None:
        """Step until a condition holds, for at most limit_s."""
        deadline_s = self._lockstep.time_s + limit_s
        while not is_so():
            if self._lockstep.time_s > deadline_s:
                raise RunError(f"{failure} within {limit_s:g} simulated seconds")
            self._step()

    def command(self, command: BoatCommand, what: str) -> None:
        """Send a command and wait until it is accepted."""

        def send(answered: Answered) -> None:
            self._station.command(command, answered, self._lockstep.time_s)

        outcome = self._outcome(send)
        if not isinstance(outcome, Accepted):
            raise RunError(f"the boat refused {what}: {outcome.text}")

    def until_armable(self) -> None:
        """Wait until the boat reports that it may be armed and has a position, which arming does not need."""
        self.wait(self._is_armable, BOOT_S, "the boat did not become armable")

    def upload(self, items: Sequence[MissionItem], kind: Kind = "mission") -> None:
        """Upload a mission, or another list."""

        def send(answered: Answered) -> None:
            self._station.upload(items, answered, self._lockstep.time_s, kind)

        outcome = self._outcome(send)
        if not isinstance(outcome, Accepted):
            said = [text for text in self._station.texts if "upload failed" in text or "refused" in text]
            words = said[-1] if said and isinstance(outcome, Refused) else outcome.text
            raise RunError(f"the boat refused the {kind}: {words}")

    def arm(self) -> None:
        """Arm the motors."""
        self.command(build_command("arm", {}, {}), "arming")

    def start_mission(self) -> None:
        """Start the mission."""
        self.command(build_command("start", {}, {}), "the start of the mission")

    def change_mode(self, number: int) -> None:
        """Enter a mode by its Rover number."""
        name = f"mode {number}"
        self.command(build_command("set_mode", {"mode": name}, {name: number}), name)

    def _outcome(self, send: Callable[[Answered], None]) -> Outcome:
        """Step until the client has the answer, or gives up."""
        outcomes: list[Outcome] = []
        send(outcomes.append)
        while not outcomes:
            self._step()
        return outcomes[0]

    def _is_armable(self) -> bool:
        status = self._station.latest.get("SYS_STATUS")
        if status is None:
            return False
        bits = dialect.MAV_SYS_STATUS_PREARM_CHECK | dialect.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
        return bool(status.onboard_control_sensors_health & bits == bits)
