"""Configuration of the hardware: drivers, pins and ports."""

import math
from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section


class MotorsPart(Section, frozen=True):
    """The motor driver. Pins in BCM numbers."""

    driver: Literal["l298n", "none"] = "none"
    left_forward: int = 5
    left_backward: int = 6
    left_enable: int = 12
    right_forward: int = 20
    right_backward: int = 21
    right_enable: int = 13
    pwm_hz: Annotated[int, Meta(ge=50, le=10000)] = 1000  # the maximum of lgpio
    dead_time_s: NonNegative = 0.02
    left_reversed: bool = False
    right_reversed: bool = False


class GnssPart(Section, frozen=True):
    """An NMEA 0183 receiver. latency_s: shortest time from measurement to first sentence."""

    driver: Literal["nmea", "none"] = "none"
    port: str = "/dev/serial0"
    baud: Positive = 9600
    latency_s: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.1  # ArduPilot assumes 0.12 to 0.22 for u-blox


class CompassPart(Section, frozen=True):
    """A heading sensor: NMEA 0183, or a BNO055 on I²C. The correction is added to its heading."""

    driver: Literal["nmea", "bno055", "none"] = "none"
    port: str = "/dev/ttyUSB0"
    baud: Positive = 4800
    correction_rad: float = 0.0
    address: Annotated[int, Meta(ge=0x08, le=0x77)] = 0x28  # of the BNO055; 0x29 where its COM3 pin is high


class SonarPart(Section, frozen=True):
    """HC-SR04 ranger, fixed or on a sweeping servo."""

    driver: Literal["hcsr04", "none"] = "none"
    trigger: int = 23
    echo: int = 24
    servo: int = -1  # −1: fixed ahead
    sweep_rad: Annotated[float, Meta(ge=0.0, le=math.pi)] = math.pi
    step_rad: Positive = math.radians(15.0)
    max_range_m: Positive = 4.0


class BatteryPart(Section, frozen=True):
    """Battery monitor."""

    driver: Literal["ina219", "none"] = "none"
    address: Annotated[int, Meta(ge=0x08, le=0x77)] = 0x40
    shunt_ohm: Positive = 0.1  # the board's shunt; beyond 0.32 V over it the current is unknown


class HullPart(Section, frozen=True):
    """The computer's thermometer, and a leak switch that closes to ground."""

    driver: Literal["host", "none"] = "none"
    thermometer: str = "/sys/class/thermal/thermal_zone0/temp"
    leak: int = -1  # the switch's pin; −1: none


class Parts(Section, frozen=True):
    """The hardware of the boat."""

    motors: MotorsPart = MotorsPart()
    gnss: GnssPart = GnssPart()
    compass: CompassPart = CompassPart()
    sonar: SonarPart = SonarPart()
    battery: BatteryPart = BatteryPart()
    hull: HullPart = HullPart()
