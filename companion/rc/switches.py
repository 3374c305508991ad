"""A transmitter's switches: one arms and disarms, one selects the mode. Only a movement counts."""

from companion.config.tuning import Rc
from companion.core.requests import Arm, ChangeMode, Disarm, Request
from companion.rc.pulses import HIGH, LOW, is_pulse, mode_position, switch_position

SETTLE_S = 0.2  # a position counts once it has stayed for so long
_UNKNOWN = -1


class Switch:
    """A debounced switch. position: the settled one, −1 before the first.

    is_steady: it has been read there for SETTLE_S since the transmitter was last lost.
    """

    def __init__(self) -> None:
        self.position = _UNKNOWN
        self.is_steady = False
        self._channel = 0
        self._seen = _UNKNOWN
        self._since_s = 0.0

    def pulse_us(self, channels_us: tuple[int, ...], channel: int) -> int:
        """Its pulse in a frame, 0 where there is none. Another channel makes its position unknown."""
        if channel != self._channel:
            self._channel = channel
            self.position = _UNKNOWN
            self.forget_position()
        if not 0 < channel <= len(channels_us) or not is_pulse(channels_us[channel - 1]):
            return 0
        return channels_us[channel - 1]

    def forget_position(self) -> None:
        """The transmitter is lost."""
        self._seen, self.is_steady = _UNKNOWN, False

    def update(self, position: int, now_s: float) -> bool:
        """Take the present position. Whether the switch has just settled in a new one."""
        if position != self._seen:
            self._seen, self._since_s = position, now_s
        self.is_steady = now_s - self._since_s >= SETTLE_S
        if position == self.position or not self.is_steady:
            return False
        self.position = position
        return True


class Switches:
    """The arming switch and the mode switch.

    The arming switch arms only when it goes up after it has been seen down, since boot and since the
    transmitter was last lost; it disarms whenever it has gone down. The mode switch is also obeyed at first
    sight while the boat is disarmed. A switch that was moved during a silence counts as moved.
    """

    def __init__(self) -> None:
        self._arm = Switch()
        self._mode = Switch()
        self._is_down = False  # the arming switch has been seen down, and may arm

    def forget_positions(self) -> None:
        """The transmitter is lost, or a station takes or leaves its channels."""
        self._is_down = False
        self._arm.forget_position()
        self._mode.forget_position()

    def update(
        self, channels_us: tuple[int, ...], is_armed: bool, setting: Rc, now_s: float
    ) -> tuple[Request, ...]:
        """Take the channels in µs. What the switches ask for."""
        arm, mode = self._arm, self._mode
        requests: tuple[Request, ...] = ()
        if pulse_us := arm.pulse_us(channels_us, setting.arm_channel):
            before = arm.position
            self._is_down = self._is_down and before != _UNKNOWN
            if arm.update(switch_position(pulse_us), now_s):
                requests = self._arm_request(before, arm.position)
            self._is_down = self._is_down or (arm.is_steady and arm.position == LOW)
        if pulse_us := mode.pulse_us(channels_us, setting.mode_channel):
            before = mode.position
            if mode.update(mode_position(pulse_us), now_s):
                number, is_initial = setting.modes[mode.position], before == _UNKNOWN
                will_be_armed = requests == (Arm(),) if requests else is_armed
                if not (is_initial and will_be_armed):
                    requests = (*requests, ChangeMode(number, is_initial))
        return requests

    def _arm_request(self, before: int, position: int) -> tuple[Request, ...]:
        if position == LOW and before != _UNKNOWN:
            return (Disarm("by the arming switch"),)
        if position == HIGH and self._is_down:
            self._is_down = False
            return (Arm(),)
        return ()
