"""AVAILABLE_MODES, CURRENT_MODE and AVAILABLE_MODES_MONITOR."""

from companion.core.modes import Mode
from companion.mavlink.dialect import Message, dialect
from companion.services.outbox import Outbox
from companion.vehicle.vehicle import Vehicle

PERIOD_S = 2.0

_MODES = tuple(Mode)
# None of Rover's modes is a standard mode
_STANDARD: int = dialect.MAV_STANDARD_MODE_NON_STANDARD


def available_mode(index: int) -> Message | None:
    """The mode with this index, from 1; None if there is none."""
    if not 1 <= index <= len(_MODES):
        return None
    mode = _MODES[index - 1]
    return dialect.MAVLink_available_modes_message(
        number_modes=len(_MODES),
        mode_index=index,
        standard_mode=_STANDARD,
        custom_mode=int(mode),
        properties=dialect.MAV_MODE_PROPERTY_ADVANCED if mode.rules.is_advanced else 0,
        mode_name=mode.rules.title.encode("ascii"),
    )


def available_modes(which: float) -> list[Message]:
    """By REQUEST_MESSAGE's second parameter: one mode, or all for 0."""
    if not 0.0 <= which <= len(_MODES):
        return []
    indexes = range(1, len(_MODES) + 1) if which == 0.0 else (int(which),)
    return [message for index in indexes if (message := available_mode(index)) is not None]


def current_mode(vehicle: Vehicle) -> Message:
    """The present mode; there are no pending mode changes."""
    return dialect.MAVLink_current_mode_message(_STANDARD, int(vehicle.mode), int(vehicle.mode))


def available_modes_monitor() -> Message:
    """The list of modes is constant."""
    return dialect.MAVLink_available_modes_monitor_message(0)


class AvailableModesService:
    """Sends the present mode every PERIOD_S and on change."""

    def __init__(self, vehicle: Vehicle, outbox: Outbox) -> None:
        self._vehicle = vehicle
        self._outbox = outbox
        self._due_s = 0.0
        self._reported = vehicle.mode

    def tick(self, now_s: float) -> None:
        if now_s >= self._due_s:
            self._due_s = now_s + PERIOD_S
            self._outbox.broadcast(available_modes_monitor())
            self._broadcast()
        else:
            self.announce_change()

    def announce_change(self) -> None:
        if self._vehicle.mode is not self._reported:
            self._broadcast()

    def _broadcast(self) -> None:
        self._reported = self._vehicle.mode
        self._outbox.broadcast(current_mode(self._vehicle))
