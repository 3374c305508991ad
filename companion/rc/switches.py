"""The switches of a transmitter: one arms and disarms, one chooses the mode. It counts that they move."""

from companion.core.modes import Mode
from companion.core.requests import Arm, ChangeMode, Disarm
from companion.rc.pulses import HIGH, LOW, is_pulse, mode_position, switch_position
from companion.vehicle.vehicle import Vehicle

SETTLE_S = 0.2  # a position counts once it has stayed for so long
_UNKNOWN = -1


class Switch:
    """A switch, read again and again. position: the one that it has settled in, −1 before the first.

    is_steady: it has been seen there for a while, and not just before the transmitter was lost.
    """

    __slots__ = ("_channel", "_seen", "_since_s", "is_steady", "position")

    def __init__(self) -> None:
        self.position = _UNKNOWN
        self.is_steady = False
        self._channel = 0
        self._seen = _UNKNOWN
        self._since_s = 0.0

    def pulse_us(self, channels_us: tuple[int, ...], channel: int) -> int:
        """Its pulse in a frame, 0 where there is none. A switch that is put on another channel is known no
        longer.
        """
        if channel != self._channel:
            self._channel = channel
            self.position = _UNKNOWN
            self.lose()
        if not 0 < channel <= len(channels_us) or not is_pulse(channels_us[channel - 1]):
            return 0
        return channels_us[channel - 1]

    def lose(self) -> None:
        """It cannot be seen."""
        self._seen, self.is_steady = _UNKNOWN, False

    def update(self, position: int, now_s: float) -> bool:
        """Take the position of now; whether it has just settled in another than before."""
        if position != self._seen:
            self._seen, self._since_s = position, now_s
        self.is_steady = now_s - self._since_s >= SETTLE_S
        if position == self.position or not self.is_steady:
            return False
        self.position = position
        return True


class Switches:
    """Both. They were moved if they are seen in another position than before, be it after a silence.

    The arming switch arms only when it goes up after it has been seen down, since boot and since the
    transmitter was last lost; it disarms whenever it has gone down. The mode switch is also obeyed at first
    sight, by a boat that is disarmed.
    """

    __slots__ = ("_arm", "_is_down", "_mode", "_vehicle")

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._arm = Switch()
        self._mode = Switch()
        self._is_down = False  # the arming switch has been seen down, and may arm

    def lose(self) -> None:
        """The transmitter is gone."""
        self._is_down = False
        self._arm.lose()
        self._mode.lose()

    def update(self, channels_us: tuple[int, ...], now_s: float) -> bool:
        """Take a good frame; whether the vehicle has been asked for something."""
        setting, arm, mode = self._vehicle.config.rc, self._arm, self._mode
        has_asked = False
        if pulse_us := arm.pulse_us(channels_us, setting.arm_channel):
            before = arm.position
            self._is_down = self._is_down and before != _UNKNOWN
            if arm.update(switch_position(pulse_us), now_s):
                has_asked = self._turn_arm(before, arm.position)
            self._is_down = self._is_down or (arm.is_steady and arm.position == LOW)
        if pulse_us := mode.pulse_us(channels_us, setting.mode_channel):
            before = mode.position
            if mode.update(mode_position(pulse_us), now_s):
                has_asked = self._turn_mode(before, setting.modes[mode.position]) or has_asked
        return has_asked

    def _turn_arm(self, before: int, position: int) -> bool:
        if position == LOW and before != _UNKNOWN:
            self._vehicle.request(Disarm("by the transmitter"))
            return True
        if position == HIGH and self._is_down:
            self._is_down = False
            self._vehicle.request(Arm())
            return True
        return False

    def _turn_mode(self, before: int, number: int) -> bool:
        vehicle = self._vehicle
        if before != _UNKNOWN:
            vehicle.request(ChangeMode(number))
        elif not vehicle.armed:
            vehicle.change_mode(Mode(number), "mode switch")
        else:
            return False
        return True
