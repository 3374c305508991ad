"""The drive's settings: a table of a boat's file."""

from companion.config.section import Positive, Section
from sitl.world.drive.bridge import BridgeParameters
from sitl.world.drive.motor import MotorParameters
from sitl.world.drive.propeller import PropellerParameters


class ThrusterParameters(Section, frozen=True):
    """A pair of equal thrusters; apart_m is the distance between the two shafts."""

    apart_m: Positive
    motor: MotorParameters
    propeller: PropellerParameters
    bridge: BridgeParameters = BridgeParameters()
