"""Response of the two thrusters, measured by the thruster calibration."""

from typing import Annotated

from msgspec import Meta

from companion.config.section import Section

DeadBand = Annotated[float, Meta(ge=0.0, le=0.6)]
Gain = Annotated[float, Meta(ge=0.2, le=1.0)]
Asymmetry = Annotated[float, Meta(ge=1.0, le=10.0)]


class Thrusters(Section, frozen=True):
    """Shares of full command. By default commands are passed unchanged.

    A dead band is the least command that gives thrust, per side, ahead and astern. The gain of the stronger
    side is below 1, so that both are equal. asymmetry: how many times more command the same thrust takes
    astern.
    """

    left_ahead: DeadBand = 0.0
    left_astern: DeadBand = 0.0
    right_ahead: DeadBand = 0.0
    right_astern: DeadBand = 0.0
    left_gain: Gain = 1.0
    right_gain: Gain = 1.0
    asymmetry: Asymmetry = 1.0
