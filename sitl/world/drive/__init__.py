"""The drive: two thrusters side by side, each a bridge, a brushed motor and a propeller."""

from sitl.world.drive.propeller import PropellerParameters
from sitl.world.drive.settings import BridgeParameters, MotorParameters, ThrusterParameters
from sitl.world.drive.thruster import Thruster, Thrusters

__all__ = [
    "BridgeParameters",
    "MotorParameters",
    "PropellerParameters",
    "Thruster",
    "ThrusterParameters",
    "Thrusters",
]
