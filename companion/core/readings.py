"""Sensor readings, stamped with the boat's clock. All frozen, all SI."""

from msgspec import Struct

from companion.core.geo import LatLon
from companion.core.vectors import Vector


class Reading(Struct, frozen=True, gc=False):
    """What all have: the time of the measurement, in seconds since boot."""

    time_s: float


class GnssFix(Reading, frozen=True, gc=False):
    """One solution of a GNSS receiver or a substitute.

    fix_type follows MAVLink's GPS_FIX_TYPE: 0/1 none, 2 = 2-D, 3 = 3-D, 4 = DGNSS, 5 = RTK float, 6 = RTK
    fixed. Velocity components are over ground, None if not reported. reset_counter changes when the source
    restarts and its positions may jump. time_of_day_s: time of the measurement by the receiver's clock (UTC
    once it has a fix), None if not reported. speed_accuracy_m_s: of the velocity, three-dimensional.
    heading_rad: by two antennas. correction_age_s: upper bound of the age of differential corrections.
    """

    position: LatLon
    fix_type: int
    satellites: int
    hdop: float
    north_m_s: float | None = None
    east_m_s: float | None = None
    altitude_m: float = 0.0
    horizontal_accuracy_m: float | None = None
    unix_time_s: float | None = None
    reset_counter: int = 0
    time_of_day_s: float | None = None
    vertical_accuracy_m: float | None = None
    speed_accuracy_m_s: float | None = None
    heading_rad: float | None = None
    heading_accuracy_rad: float | None = None
    correction_age_s: float | None = None


class HeadingReading(Reading, frozen=True, gc=False):
    """Heading in radians, clockwise from true or (is_magnetic) magnetic north; the yaw rate if there is a
    gyro.

    roll_rad (positive to starboard) and pitch_rad (bow up) if measured. field_mg: the magnetic field in body
    axes, in mG, before any correction, if the part is a magnetometer.
    """

    heading_rad: float
    yaw_rate_rad_s: float | None = None
    roll_rad: float | None = None
    pitch_rad: float | None = None
    field_mg: Vector | None = None
    is_magnetic: bool = False


class SonarReading(Reading, frozen=True, gc=False):
    """One ping. bearing_rad is relative to the bow, clockwise; range_m is None without an echo."""

    bearing_rad: float
    range_m: float | None
    min_range_m: float = 0.02
    max_range_m: float = 4.0


class DepthReading(Reading, frozen=True, gc=False):
    """One sounding. depth_m is below the transducer, None where no bottom was found.

    transducer_m: depth of the transducer below the surface. quality: 0..1, None if not reported.
    """

    depth_m: float | None
    temperature_c: float | None = None  # of the water
    transducer_m: float = 0.0
    min_range_m: float = 0.3
    max_range_m: float = 100.0
    quality: float | None = None

    @property
    def water_m(self) -> float | None:
        """Depth of the water, None where no bottom was found."""
        return None if self.depth_m is None else self.depth_m + self.transducer_m


class ProbeReading(Reading, frozen=True, gc=False):
    name: str
    value: float
    unit: str = ""


class BatteryReading(Reading, frozen=True, gc=False):
    """Battery voltage and current. current_a is positive while discharging, None if not measured."""

    voltage_v: float
    current_a: float | None = None


class EscReading(Reading, frozen=True, gc=False):
    """What a speed controller measures. side: 0 left, 1 right. count: of its readings since the start.

    shaft_rad_s: speed of the shaft, as the configured pole pairs give it; a part that does not tell the
    direction gives its size. fault: what the part reports, in words, empty if nothing.
    """

    side: int
    count: int
    shaft_rad_s: float
    voltage_v: float
    current_a: float  # from the pack
    temperature_c: float
    consumed_mah: float
    motor_c: float | None = None
    fault: str = ""


EscPair = tuple[EscReading | None, EscReading | None]
"""Left and right, None while silent."""


class HullReading(Reading, frozen=True, gc=False):
    """Leak and highest temperature inside the hull. None: not measured."""

    is_wet: bool | None = None
    temperature_c: float | None = None


class AisVessel(Struct, frozen=True, gc=False):
    """A vessel as its AIS reports it; None: not known. time_s: when its position arrived.

    turn_rad_s: positive to starboard, infinite if only the side is known. status and kind are the numbers of
    ITU-R M.1371, 15 and 0 if unknown. error_m: of the position, 95 %. bow_m, stern_m, port_m, starboard_m:
    from the antenna; all 0 if unknown, bow and port 0 where only length (stern) and beam are known.
    """

    mmsi: int
    time_s: float
    position: LatLon
    speed_m_s: float | None = None
    course_rad: float | None = None
    heading_rad: float | None = None
    turn_rad_s: float | None = None
    status: int = 15
    kind: int = 0
    is_class_b: bool = False
    is_accurate: bool = False
    is_doubtful: bool = False  # its latest position does not agree with the one before
    error_m: float = 0.0
    name: str = ""
    callsign: str = ""
    bow_m: int = 0
    stern_m: int = 0
    port_m: int = 0
    starboard_m: int = 0


class AisReading(Reading, frozen=True):
    """All vessels with a position that can be believed. time_s: of the latest message of any station."""

    vessels: tuple[AisVessel, ...] = ()


class RcReading(Reading, frozen=True, gc=False):
    """Channels of an RC receiver: pulse widths in µs, channel 1 first.

    is_failsafe: the receiver reports a lost transmitter; the channels are invalid. quality: share of packets
    received, 0..1; rssi_dbm: signal strength. Both None if not reported.
    """

    channels_us: tuple[int, ...]
    is_failsafe: bool = False
    quality: float | None = None
    rssi_dbm: float | None = None
