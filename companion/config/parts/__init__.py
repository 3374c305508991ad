"""Configuration of the hardware: drivers, pins and ports; one file a kind of part."""

from companion.config.board import I2cBus
from companion.config.parts.battery import BatteryPart
from companion.config.parts.depth import DepthPart
from companion.config.parts.gnss import GnssPart
from companion.config.parts.heading import CompassPart, Mounting
from companion.config.parts.hull import HullPart
from companion.config.parts.motors import MotorsPart
from companion.config.parts.pulses import Pca9685Part, PulseOutputSetting
from companion.config.parts.ranging import RangerPart
from companion.config.parts.rudder import RudderPart
from companion.config.section import Section

__all__ = [
    "BatteryPart",
    "CompassPart",
    "DepthPart",
    "GnssPart",
    "HullPart",
    "MotorsPart",
    "Mounting",
    "Parts",
    "Pca9685Part",
    "PulseOutputSetting",
    "RangerPart",
    "RudderPart",
]


class Parts(Section, frozen=True):
    """The hardware of the boat. i2c_bus: of all parts that do not name another."""

    i2c_bus: I2cBus = 1
    motors: MotorsPart = MotorsPart()
    rudder: RudderPart = RudderPart()
    gnss: GnssPart = GnssPart()
    compass: CompassPart = CompassPart()
    sonar: RangerPart = RangerPart()
    battery: BatteryPart = BatteryPart()
    hull: HullPart = HullPart()
    depth: DepthPart = DepthPart()
    pca9685: Pca9685Part = Pca9685Part()
