"""A radio control transmitter as somebody who may steer: sticks, switches, and who goes before whom."""

from companion.core.status_text import Severity
from companion.rc.switches import Switches
from companion.sensors.readings import RcReading
from companion.vehicle.vehicle import Vehicle

_NEWS = 0.01  # a stick that has moved by less can wait for guidance's next turn


class RcControl:
    """Hands what the receiver says to the vehicle. A station's sticks, while fresh, go before it."""

    __slots__ = ("_is_overridden", "_reading", "_steering", "_switches", "_throttle", "_vehicle")

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._switches = Switches(vehicle)
        self._reading: RcReading | None = None
        self._steering = self._throttle = 0.0  # as guidance was last told
        self._is_overridden = False

    def update(self, reading: RcReading, now_s: float) -> bool:
        """Take the receiver's latest reading, which may be the one of before.

        Returns whether something has changed that guidance should not wait for.
        """
        vehicle = self._vehicle
        sticks, setting = vehicle.manual_input, vehicle.config.rc
        radio = sticks.rc
        if reading is self._reading:
            return False
        self._reading = reading
        if not radio.is_fresh(setting, reading.time_s):
            self._switches.lose()
        if not radio.ingest(reading, setting):
            return False
        is_overridden = sticks.has_station(vehicle.config, now_s)
        if is_overridden is not self._is_overridden:
            self._is_overridden = is_overridden
            if vehicle.mode.is_by_hand:
                who = (
                    "a station's sticks go before the transmitter's"
                    if is_overridden
                    else "the transmitter's again"
                )
                vehicle.notify(Severity.NOTICE, f"Helm: {who}")
        if self._switches.update(reading.channels_us, now_s):
            return True
        if is_overridden or not (vehicle.armed and vehicle.mode.is_by_hand):
            return False
        off = abs(radio.steering - self._steering) + abs(radio.throttle - self._throttle)
        if off < _NEWS:
            return False
        self._steering, self._throttle = radio.steering, radio.throttle
        return True
