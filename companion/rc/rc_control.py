"""What the RC transmitter, or a station's override of its channels, asks for: sticks, switches, the helm."""

from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.modes import Mode
from companion.core.readings import RcReading
from companion.core.requests import Request
from companion.rc.manual_input import ManualInput
from companion.rc.switches import Switches

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
        self._overridden: set[int] = set()  # the switches' channels that a station holds

    def update(
        self,
        reading: RcReading | None,
        sticks: ManualInput,
        mode: Mode,
        armed: bool,
        config: BoatConfig,
        now_s: float,
    ) -> RcActions:
        """Take the receiver's latest reading, which may be the previous one again, or None without one."""
        overridden = sticks.overridden(config, now_s).keys() & {config.rc.arm_channel, config.rc.mode_channel}
        if overridden != self._overridden:
            self._overridden = overridden
            self._switches.forget_positions()
        is_good = self._ingest(reading, sticks, config)
        if not (is_good or overridden):
            return _NOTHING
        channels_us = sticks.channels_us(config, now_s)
        requests = self._switches.update(channels_us, armed, config.rc, now_s)
        if not is_good:
            return RcActions(requests, is_urgent=bool(requests))
        rc, by_hand = sticks.rc, mode.rules.is_by_hand
        text, is_overridden = "", sticks.has_station(config, now_s)
        if is_overridden is not self._is_overridden:
            self._is_overridden = is_overridden
            if by_hand:
                text = "a station's sticks have priority" if is_overridden else "the transmitter's again"
                text = f"Helm: {text}"
        if requests:
            return RcActions(requests, text, is_urgent=True)
        change = abs(rc.steering - self._steering) + abs(rc.throttle - self._throttle)
        is_urgent = change >= _STICK_CHANGE and not is_overridden and armed and by_hand
        if is_urgent:
            self._steering, self._throttle = rc.steering, rc.throttle
        return RcActions((), text, is_urgent)

    def _ingest(self, reading: RcReading | None, sticks: ManualInput, config: BoatConfig) -> bool:
        """Take the receiver's reading. Whether it is a new frame, and good."""
        last, self._reading = self._reading, reading
        if reading is None or reading is last:
            return False
        if not sticks.rc.is_fresh(config.rc, reading.time_s):
            self._switches.forget_positions()
        return sticks.rc.ingest(reading, config.rc)
