"""The vehicle's status: what guidance, calibration and the RC receiver's switches depend on."""

from msgspec import Struct

from companion.core.modes import Mode
from companion.core.state import HEALTHY_MOTORS, MotorStates


class VehicleStatus(Struct, frozen=True, gc=False):
    """One tick's status.

    failsafes: bits of the failsafes that are active. needs_position: False while the intent needs a heading
    only. output_fault: why motors or rudder cannot be driven.
    """

    mode: Mode = Mode.HOLD
    armed: bool = False
    failsafes: int = 0
    needs_position: bool = True
    is_ungrounding: bool = False
    is_checking_motors: bool = False
    motors: MotorStates = HEALTHY_MOTORS
    is_restarting: bool = False
    output_fault: str = ""
