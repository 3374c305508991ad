"""The RC receiver, and the meaning of the transmitter's channels."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import Positive, Section
from companion.core.modes import Mode

Pulse = Annotated[int, Meta(ge=800, le=2200)]
StickChannel = Annotated[int, Meta(ge=1, le=4)]
SwitchChannel = Annotated[int, Meta(ge=0, le=18)]


class RcChannel(Section, frozen=True):
    """A stick channel in µs of pulse width: end points, trim, and dead zone.

    A throttle without reverse has its trim at the minimum.
    """

    min_us: Pulse = 1000
    trim_us: Pulse = 1500
    max_us: Pulse = 2000
    dead_us: Annotated[int, Meta(ge=0, le=200)] = 30
    is_reversed: bool = False


class Rc(Section, frozen=True):
    """A receiver on a UART, and the transmitter's sticks and switches. Channels count from 1; 0: none.

    failsafe_us: a shorter throttle pulse means a lost transmitter; 0: never.
    """

    driver: Literal["crsf", "ibus", "sbus", "none"] = "none"
    port: str = "/dev/ttyAMA4"
    timeout_s: Positive = 0.5  # without a good frame the transmitter is lost
    failsafe_us: Annotated[int, Meta(ge=0, le=1100)] = 910
    steering_channel: StickChannel = 1
    throttle_channel: StickChannel = 3
    channel_1: RcChannel = RcChannel()
    channel_2: RcChannel = RcChannel()
    channel_3: RcChannel = RcChannel()
    channel_4: RcChannel = RcChannel()
    arm_channel: SwitchChannel = 0  # up arms, down disarms
    mode_channel: SwitchChannel = 0
    mode_1: Mode = Mode.MANUAL  # by Rover's number, for the six positions of the mode switch
    mode_2: Mode = Mode.HOLD
    mode_3: Mode = Mode.LOITER
    mode_4: Mode = Mode.AUTO
    mode_5: Mode = Mode.RTL
    mode_6: Mode = Mode.GUIDED

    @property
    def steering(self) -> RcChannel:
        """The steering stick's channel."""
        return self.stick(self.steering_channel)

    @property
    def throttle(self) -> RcChannel:
        """The throttle stick's channel."""
        return self.stick(self.throttle_channel)

    @property
    def modes(self) -> tuple[Mode, ...]:
        """The modes of the switch's six positions."""
        return (self.mode_1, self.mode_2, self.mode_3, self.mode_4, self.mode_5, self.mode_6)

    def stick(self, number: int) -> RcChannel:
        """The stick channel 1 to 4."""
        return (self.channel_1, self.channel_2, self.channel_3, self.channel_4)[number - 1]
