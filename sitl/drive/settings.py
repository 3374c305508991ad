"""The drive's settings: a table of a boat's file."""

from companion.section import Positive, Section
from sitl.drive.bridge import BridgeParameters
from sitl.drive.motor import MotorParameters
from sitl.drive.propeller import PropellerParameters


class ThrusterParameters(Section, frozen=True):
    """A pair of equal thrusters; apart_m is the distance between the two shafts."""

    apart_m: Positive
    motor: MotorParameters
    propeller: PropellerParameters
    bridge: BridgeParameters = BridgeParameters()
