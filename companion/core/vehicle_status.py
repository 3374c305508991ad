"""The vehicle's status: what guidance, calibration and the RC receiver's switches depend on."""

from typing import NamedTuple

from companion.core.modes import Mode


class VehicleStatus(NamedTuple):
    """One tick's status.

    failsafes: bits of the failsafes that are active. needs_position: False while the intent needs a heading
    only. left_motor and right_motor: 1 in order, 0 no thrust, -1 reversed.
    """

    mode: Mode = Mode.HOLD
    armed: bool = False
    failsafes: int = 0
    needs_position: bool = True
    is_ungrounding: bool = False
    is_checking_motors: bool = False
    left_motor: int = 1
    right_motor: int = 1
    is_restarting: bool = False
