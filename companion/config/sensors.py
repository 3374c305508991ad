"""Configuration of the sensors: drivers, ports and pins."""

import math
import re
from collections.abc import Sequence
from typing import Annotated, Final, Literal, get_args

from msgspec import Meta

from companion.config.board import I2cBus, OptionalPin, Pin
from companion.config.section import NonNegative, Positive, Section, Share


class GnssPart(Section, frozen=True):
    """A receiver with NMEA 0183 output, a u-blox receiver (ubx), which is set up at start, or gpsd.

    port: a device, another port url, or HOST:PORT of gpsd.

    latency_s: shortest time from measurement to first sentence. rate_hz: to which a u-blox receiver is set.
    With two antennas, baseline_m is their distance (0: any), and antenna_bearing_rad the direction from the
    reference antenna to the receiver's own, clockwise from the bow.
    """

    driver: Literal["nmea", "ubx", "gpsd", "autopilot", "none"] = "none"
    port: str = "/dev/serial0"
    # 0: 9600 for nmea; for ubx the receiver is set to 115200, whatever its rate is at first
    baud: NonNegative = 0.0
    rate_hz: Annotated[float, Meta(ge=1.0, le=20.0)] = 5.0
    baseline_m: NonNegative = 0.0
    antenna_bearing_rad: float = 0.0
    timeout_s: Positive = 4.0  # without a fix the receiver is silent: as ArduPilot; four of one a second
    latency_s: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.1  # ArduPilot assumes 0.12 to 0.22 for u-blox


MagnetometerDriver = Literal[
    "qmc5883l", "qmc5883p", "hmc5883l", "lis3mdl", "ist8310", "ist8308", "rm3100", "ak09916"
]
CompassDriver = Literal["nmea", "bno055", "bno085", MagnetometerDriver]
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

    driver: Literal[CompassDriver, "gnss", "autopilot", "none"] = "none"
    fallback: Literal[CompassDriver, "none"] = "none"
    port: str = "/dev/ttyUSB0"
    baud: Positive = 4800
    correction_rad: float = 0.0
    timeout_s: NonNegative = 0.0  # without a reading it is silent; 0: by the driver
    i2c_bus: I2cBus = 1  # of parts.i2c_bus unless given
    address: BusAddress = 0  # on I²C; 0: the part's usual one
    mounting: Mounting = Mounting()  # of the BNO055, BNO085 or magnetometer
    # Gyro and accelerometer beside a magnetometer
    imu: Literal["mpu6050", "lsm6ds", "icm20948", "none"] = "none"
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
        return self.part_driver in get_args(MagnetometerDriver)


# Least and greatest range by the data sheets: Elecfreaks HC-SR04; JSN-SR04T (blind 25 cm); DFRobot SEN0311
# (A02YYUW); Benewake TFmini Plus and TFmini-S. Of scanning lidars the greatest is that of dark things (LD19P,
# STL-19P: 8 m at 4 % reflectance) or of the part's older models (SLAMTEC LD108, A1M8 to R4: 6 m): farther off
# they hear white ones only, and silence there is no free water.
RANGES_M: Final = {
    "hcsr04": (0.02, 4.0),
    "jsnsr04t": (0.25, 4.5),
    "a02yyuw": (0.03, 4.5),
    "tfmini": (0.1, 12.0),
    "ld06": (0.03, 8.0),
    "rplidar_a1": (0.15, 6.0),
    "autopilot": (0.2, 7.0),  # RNGFND1_MIN and _MAX as delivered
    "none": (0.02, 4.0),
}


class RangedPart(Section, frozen=True):
    """A part with the range of its driver's data sheet, or another."""

    driver: str = "none"
    min_range_m: NonNegative = 0.0  # nothing closer is seen; 0: that of the data sheet
    max_range_m: NonNegative = 0.0  # 0: that of the data sheet

    def __post_init__(self) -> None:
        super().__post_init__()
        least_m, greatest_m = self.range_m
        if least_m >= greatest_m:
            raise ValueError(
                f"min_range_m = {least_m:g}: expected less than the greatest range, {greatest_m:g}"
            )

    @property
    def range_m(self) -> tuple[float, float]:
        least_m, greatest_m = RANGES_M[self.driver]
        return self.min_range_m or least_m, self.max_range_m or greatest_m


class RangerPart(RangedPart, frozen=True):
    """A ranger, fixed or on a sweeping servo: ultrasonic with trigger and echo pins (HC-SR04, JSN-SR04T) or
    on a serial port (A02YYUW), or a lidar on a serial port (TFmini).
    """

    driver: Literal["hcsr04", "jsnsr04t", "a02yyuw", "tfmini", "autopilot", "none"] = "none"
    trigger: Pin = 23
    echo: Pin = 24
    port: str = "/dev/ttyUSB1"
    min_strength: Annotated[int, Meta(ge=0, le=65534)] = 100  # of a lidar's echo; the first TFmini: 20
    servo: OptionalPin = -1  # −1: fixed ahead
    sweep_rad: Annotated[float, Meta(ge=0.0, le=math.pi)] = math.pi
    step_rad: Positive = math.radians(15.0)
    air_c: Annotated[float, Meta(ge=-40.0, le=60.0)] = 15.0  # with echo pins; 10 °C are 1.8 % of the range

    @property
    def is_laser(self) -> bool:
        return self.driver == "tfmini"


Bearing = Annotated[float, Meta(ge=-math.tau, le=math.tau)]


class LidarPart(RangedPart, frozen=True):
    """A scanning lidar on a serial port: LDROBOT LD06, LD19 or STL-19P, or Slamtec RPLIDAR A1.

    yaw_rad: direction of its zero, clockwise from the bow. blind_rad: what mast or cabin hide, as pairs of
    bearings from the bow, clockwise from the first to the second.
    """

    driver: Literal["ld06", "rplidar_a1", "none"] = "none"
    port: str = "/dev/ttyUSB3"
    baud: Annotated[int, Meta(ge=0)] = 0  # 0: 230,400 of an LD06, 115,200 of an RPLIDAR A1
    yaw_rad: Bearing = 0.0
    upside_down: bool = False
    blind_rad: tuple[tuple[Bearing, Bearing], ...] = ()
    # between two readings of a direction: every second pass of an LD06 at 10 Hz, each of an A1's 5.5 to 8 Hz
    period_s: NonNegative = 0.12

    def __post_init__(self) -> None:
        super().__post_init__()
        for first, last in self.blind_rad:
            if (last - first) % math.tau > math.pi:
                raise ValueError(f"blind_rad = [{first:g}, {last:g}]: hides more than 180° clockwise")

    def is_blind(self, bearing_rad: float, half_rad: float) -> bool:
        """Whether a part of the sector of half_rad to either side is hidden."""
        return any(
            (bearing_rad + half_rad - first) % math.tau <= (last - first) % math.tau + 2.0 * half_rad
            for first, last in self.blind_rad
        )


class DepthPart(Section, frozen=True):
    """A depth sounder: NMEA 0183 (DPT, DBT, MTW) on a port of its own or among the sentences of the GNSS
    receiver, or a Ping1D.

    forward_m, starboard_m: the transducer's place from the boat's reference point, the GNSS antenna.
    latency_s: from the echo until the sounding has arrived. What reads the log applies both.
    """

    driver: Literal["nmea", "gnss", "ping1d", "autopilot", "none"] = "none"
    port: str = "/dev/ttyUSB2"
    baud: Annotated[int, Meta(ge=0)] = 0  # 0: 4800 for NMEA, 115,200 for the Ping1D
    timeout_s: Positive = 5.0  # without a sounding it is silent: five sentences of an NMEA sounder
    transducer_m: NonNegative = 0.0  # its depth below the surface; 0: as the sounder says
    forward_m: float = 0.0
    starboard_m: float = 0.0
    # Hydromagic's manual: 10 to 100 ms from a ping to the serial port; HYPACK's example: a tenth of a second.
    # One that averages takes longer: measure it by lines both ways over a slope.
    latency_s: Annotated[float, Meta(ge=0.0, le=5.0)] = 0.1
    min_range_m: NonNegative = 0.3
    max_range_m: Positive = 100.0
    # Ping1D only
    sound_m_s: Annotated[float, Meta(ge=1300.0, le=1700.0)] = 1480.0  # fresh water at 20 °C; the sea 1500
    min_confidence: Share = 0.5  # readings below it found no bottom


class AisPart(Section, frozen=True):
    """An AIS receiver with NMEA 0183 output (AIVDM, AIVDO), on a device or another port url.

    mmsi: the boat's own number, whose reports are no vessel; 0: only those that its transponder tells as own.
    """

    driver: Literal["nmea", "none"] = "none"
    port: str = "/dev/ttyUSB3"
    baud: Annotated[int, Meta(ge=1)] = 38400  # of IEC 61162-2
    timeout_s: Positive = 360.0  # silent: no station near has told anything, two intervals of one at anchor
    mmsi: Annotated[int, Meta(ge=0, le=999_999_999)] = 0


class BatteryPart(Section, frozen=True):
    """Battery monitor on I²C: across a shunt (INA219, INA226, INA228), or by divider and Hall sensor on the
    inputs of an ADS1115. Or what speed controllers with telemetry report ("esc"), without the electronics.
    """

    driver: Literal["ina219", "ina226", "ina228", "ads1115", "esc", "autopilot", "none"] = "none"
    i2c_bus: I2cBus = 1  # of parts.i2c_bus unless given
    address: Annotated[int, Meta(ge=0, le=0x77)] = 0  # 0: 0x40, of the ADS1115 0x48
    timeout_s: Positive = 3.0  # without a reading it is silent: 30 at its 10 Hz; ArduPilot waits 5 s
    # The board's shunt. Beyond 0.32 V over it (INA219), 0.082 V (INA226) or 0.164 V (INA228) the current is
    # unknown.
    shunt_ohm: Positive = 0.1
    voltage_channel: Annotated[int, Meta(ge=0, le=3)] = 0
    divider: Positive = 11.0  # pack volts per volt at the input: 100 kΩ above 10 kΩ
    current_channel: Annotated[int, Meta(ge=-1, le=3)] = 1  # −1: no Hall sensor
    volt_per_a: float = 0.0264  # ACS758LCB-050B at 3.3 V: 40 mV/A at 5 V, and in proportion to its supply
    zero_v: float = 1.65  # its output without a current: half the supply

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.volt_per_a == 0.0:
            raise ValueError("volt_per_a = 0: expected the sensor's volts per ampere, negative if reversed")


class HullPart(Section, frozen=True):
    """The computer's thermometer, and a leak switch to ground.

    leak_wet: what water does to the switch. One that water opens reads wet when its wire breaks, too.
    """

    driver: Literal["host", "none"] = "none"
    thermometer: str = "/sys/class/thermal/thermal_zone0/temp"
    timeout_s: Positive = 5.0  # without a reading it is silent: five at its 1 Hz
    leak: OptionalPin = -1  # the switch's pin; −1: none
    leak_wet: Literal["closed", "open"] = "closed"


_NAME = r"^[!-~]{1,10}$"  # what NAMED_VALUE_FLOAT can carry
_UNIT = r"^[!-~]{0,16}$"


class ProbePart(Section, frozen=True):
    """A further number to send and log: an input of an ADS1115, a serial line, or a file such as that of a
    DS18B20 thermometer. Its value is scale times what the source says, plus offset.

    column: of the text's words, from 0, separated by commas, semicolons or spaces; pattern: a regular
    expression whose first group is the number. Without either, the text is a number.
    """

    name: Annotated[str, Meta(pattern=_NAME)]
    driver: Literal["ads1115", "serial", "file"]
    unit: Annotated[str, Meta(pattern=_UNIT)] = ""
    scale: float = 1.0
    offset: float = 0.0
    rate_hz: Annotated[float, Meta(gt=0.0, le=10.0)] = 1.0
    timeout_s: Positive = 10.0  # silent for longer is told, and no longer sent
    invalid: tuple[float, ...] = ()  # what the source says where it has not measured: 85000 of a DS18B20
    i2c_bus: I2cBus = 1  # of parts.i2c_bus unless given
    address: Annotated[int, Meta(ge=0x48, le=0x4B)] = 0x48
    channel: Annotated[int, Meta(ge=0, le=3)] = 0
    port: str = ""
    baud: Annotated[int, Meta(ge=1)] = 9600
    path: str = ""  # an asterisk stands for any text; the first that fits is read
    pattern: str = ""
    column: Annotated[int, Meta(ge=-1, le=100)] = -1
    min_value: float | None = None  # values beyond are no measurements
    max_value: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        try:
            groups = re.compile(self.pattern).groups
        except re.error as error:
            raise ValueError(f"pattern = {self.pattern!r}: {error}") from None
        if self.pattern and groups < 1:
            raise ValueError(f"pattern = {self.pattern!r}: expected a group in brackets around the number")
        if self.driver == "serial" and not self.port:
            raise ValueError(f"port of the probe {self.name}: expected a device, such as /dev/ttyUSB3")
        if self.driver == "file" and not self.path:
            raise ValueError(f"path of the probe {self.name}: expected a file")


def check_probes(probes: Sequence[ProbePart]) -> None:
    """Raises ValueError: two have one name, or one port and different baud rates."""
    names = [probe.name for probe in probes]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"probe: two are named {name!r}")
    bauds: dict[str, int] = {}
    for probe in probes:
        if probe.driver == "serial" and bauds.setdefault(probe.port, probe.baud) != probe.baud:
            raise ValueError(
                f"baud of the probe {probe.name}: another on {probe.port} has {bauds[probe.port]}"
            )
