"""Configuration of the heading sensor."""

import math
from typing import Annotated, Literal

from msgspec import Meta

from companion.config.board import I2cBus
from companion.config.section import NonNegative, Positive, Section

Driver = Literal["nmea", "bno055", "bno085", "qmc5883l", "qmc5883p", "hmc5883l", "lis3mdl"]
QuarterTurn = Literal[0, 90, 180, 270]
BusAddress = Annotated[int, Meta(ge=0, le=0x77)]


class Mounting(Section, frozen=True):
    """How a board is turned from its usual position: flat, component side up, its x arrow to the bow.

    The board is rolled about its x axis, then pitched, then yawed, clockwise seen along the axis (x ahead, y
    to starboard, z down): with yaw_deg = 90 its arrow points to starboard; with roll_deg = 180 it is upside
    down.
    """

    roll_deg: QuarterTurn = 0
    pitch_deg: QuarterTurn = 0
    yaw_deg: QuarterTurn = 0


class CompassPart(Section, frozen=True):
    """A heading sensor: NMEA 0183, a BNO055 or BNO085, a magnetometer on I²C, or the two antennas of the GNSS
    receiver (gnss), with another driver for the time while these give no heading.

    correction_rad is added to its heading. The declination is added too where the part's north is magnetic.
    """

    driver: Literal[Driver, "gnss", "none"] = "none"
    fallback: Literal[Driver, "none"] = "none"
    port: str = "/dev/ttyUSB0"
    baud: Positive = 4800
    correction_rad: float = 0.0
    timeout_s: NonNegative = 0.0  # without a reading it is silent; 0: by the driver
    i2c_bus: I2cBus = 1  # of parts.i2c_bus unless given
    address: BusAddress = 0  # on I²C; 0: the part's usual one
    mounting: Mounting = Mounting()  # of the BNO055, BNO085 or magnetometer
    imu: Literal["mpu6050", "lsm6ds", "none"] = "none"  # gyro and accelerometer beside a magnetometer
    imu_address: BusAddress = 0
    imu_mounting: Mounting = Mounting()
    auto_declination: bool = False  # from the world magnetic model
    declination_rad: Annotated[float, Meta(ge=-math.pi, le=math.pi)] = 0.0  # east positive; without the model

    @property
    def silence_s(self) -> float:
        """Without a reading for so long it is silent. ArduPilot gives a compass 0.5 s; sentences and antennas
        may come once a second.
        """
        return self.timeout_s or (1.5 if self.driver in ("nmea", "gnss") else 0.5)

    @property
    def part_driver(self) -> str:
        """The driver of the part on port or bus: with two antennas it is the fallback's."""
        return self.fallback if self.driver == "gnss" else self.driver

    @property
    def is_magnetometer(self) -> bool:
        """Whether the boat calibrates the part, which does not calibrate itself."""
        return self.part_driver in ("qmc5883l", "qmc5883p", "hmc5883l", "lis3mdl")
