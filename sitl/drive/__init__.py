"""The drive: two thrusters side by side, each a bridge, a brushed motor and a propeller."""

from sitl.drive.bridge import BridgeParameters
from sitl.drive.motor import MotorParameters
from sitl.drive.propeller import PropellerParameters
from sitl.drive.settings import ThrusterParameters
from sitl.drive.thruster import Thruster, Thrusters

__all__ = [
    "BridgeParameters",
    "MotorParameters",
    "PropellerParameters",
    "Thruster",
    "ThrusterParameters",
    "Thrusters",
]
