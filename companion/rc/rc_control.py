"""What the RC transmitter asks for: its sticks, its switches, and who has the helm."""

from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.requests import Request
from companion.core.vehicle_status import VehicleStatus
from companion.rc.manual_input import ManualInput
from companion.rc.switches import Switches
from companion.sensors.readings import RcReading

_STICK_CHANGE = 0.01  # a stick that has moved by less can wait for guidance's next cycle


class RcActions(NamedTuple):
    """requests: what the switches ask for. text: a notice. is_urgent: guidance should not wait."""

    requests: tuple[Request, ...] = ()
    text: str = ""
    is_urgent: bool = False


_NOTHING = RcActions()


class RcControl:
    """Passes the receiver's frames to the sticks. A station's sticks, while fresh, have priority."""

    def __init__(self) -> None:
        self._switches = Switches()
        self._reading: RcReading | None = None
        self._steering = self._throttle = 0.0  # at the last urgent update
        self._is_overridden = False

    def update(
        self, reading: RcReading, sticks: ManualInput, status: VehicleStatus, config: BoatConfig, now_s: float
    ) -> RcActions:
        """Take the receiver's latest reading, which may be the previous one again."""
        if reading is self._reading:
            return _NOTHING
        self._reading = reading
        rc, by_hand = sticks.rc, status.mode.is_by_hand
        if not rc.is_fresh(config.rc, reading.time_s):
            self._switches.forget_positions()
        if not rc.ingest(reading, config.rc):
            return _NOTHING
        text, is_overridden = "", sticks.has_station(config, now_s)
        if is_overridden is not self._is_overridden:
            self._is_overridden = is_overridden
            if by_hand:
                text = "a station's sticks have priority" if is_overridden else "the transmitter's again"
                text = f"Helm: {text}"
        if requests := self._switches.update(reading.channels_us, status.armed, config.rc, now_s):
            return RcActions(requests, text, is_urgent=True)
        change = abs(rc.steering - self._steering) + abs(rc.throttle - self._throttle)
        is_urgent = change >= _STICK_CHANGE and not is_overridden and status.armed and by_hand
        if is_urgent:
            self._steering, self._throttle = rc.steering, rc.throttle
        return RcActions((), text, is_urgent)
