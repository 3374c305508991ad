"""QGroundControl's compass page for an ArduPilot boat, by its source (APMSensorsComponent.cc and
APMSensorsComponentController.cc, 2024).

It asks for a setup while the offsets of a used compass are all zero. It probes with a cancellation, raises
the limit of the fit, starts the compasses that are present and used, and ends with a report of each of them,
whatever the progress was. Then it restores the limit and reads the parameters again.
"""

from boat_rig import BOAT, OK, Rig

from companion.mavlink.dialect import Message, dialect

_NUMBERS = ("", "2", "3")
_LIMIT = "COMPASS_CAL_FIT"


class QgcCompassPage:
    """log: what the page shows. verdict: empty while it waits."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.log: list[str] = []
        self.verdict = ""
        self.bar: list[float] = []
        self._limit = self._value(_LIMIT)
        self._is_complete = [True, True, True]
        self._has_succeeded = [True, True, True]
        self._is_running = False

    def _value(self, name: str) -> float:
        message = dialect.MAVLink_param_request_read_message(*BOAT, name.encode(), -1)
        return float(self.rig.answer_to(message, "PARAM_VALUE").param_value)

    def _set(self, name: str, value: float) -> None:
        self.rig.peer.send(dialect.MAVLink_param_set_message(*BOAT, name.encode(), value, 9))
        self.rig.receive()

    @property
    def needs_setup(self) -> bool:
        """The red dot beside the page."""
        return any(
            self._value(f"COMPASS_DEV_ID{number}") != 0.0
            and self._value(f"COMPASS_USE{number}") != 0.0
            and not any(self._value(f"COMPASS_OFS{number}_{axis}") for axis in "XYZ")
            for number in _NUMBERS
        )

    def press_ok(self) -> None:
        """The button."""
        if self.rig.ask(dialect.MAV_CMD_DO_CANCEL_MAG_CAL) != OK:
            self.verdict = "nothing appears"
            return
        mask = 0
        for index, number in enumerate(_NUMBERS):
            if self._value(f"COMPASS_DEV_ID{number}") > 0.0 and self._value(f"COMPASS_USE{number}"):
                mask |= 1 << index
                self._is_complete[index] = self._has_succeeded[index] = False
        self._set(_LIMIT, 100.0)
        self._is_running = True
        self.rig.peer.forget()
        self.rig.peer.command(dialect.MAV_CMD_DO_START_MAG_CAL, float(mask), 0.0, 1.0, 0.0, 0.0)
        self.rig.receive()

    def listen(self) -> None:
        """Take what the boat has said since the last call."""
        for message in self.rig.peer.listen():
            if self._is_running:
                self._take(message)

    def _take(self, message: Message) -> None:
        match message.get_type():
            case "STATUSTEXT":
                self.log.append(message.text)
            case "MAG_CAL_PROGRESS" if message.compass_id < 3 and message.cal_mask & 7:
                self.bar.append(message.completion_pct / (message.cal_mask & 7).bit_count())
            case "MAG_CAL_REPORT" if message.compass_id < 3 and not self._is_complete[message.compass_id]:
                is_good = message.cal_status == dialect.MAG_CAL_SUCCESS
                self._is_complete[message.compass_id], self._has_succeeded[message.compass_id] = True, is_good
                said = "complete" if is_good else "below quality threshold"
                self.log.append(f"Compass {message.compass_id} calibration {said}")
                if all(self._is_complete):
                    self._stop()

    def _stop(self) -> None:
        self._is_running = False
        is_good = all(self._has_succeeded)
        self.verdict = "All compasses calibrated successfully" if is_good else "Compass calibration failed"
        self._set(_LIMIT, self._limit)
