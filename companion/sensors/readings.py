"""What the boat's sensors say: values, stamped with the boat's clock. All frozen, all SI."""

from msgspec import Struct

from companion.core.geo import LatLon


class GnssFix(Struct, frozen=True, gc=False):
    """One solution of a satellite receiver, or of whatever stands in for one.

    fix_type follows MAVLink's GPS_FIX_TYPE: 0/1 none, 2 = 2-D, 3 = 3-D, 4 = DGNSS, 5 = RTK float,
    6 = RTK fixed. Velocity components are over ground; None where the receiver does not say. reset_counter
    changes when the source begins anew and its positions may leap. time_of_day_s: of the measurement, by the
    receiver's own clock (UTC once it has heard satellites), None where it does not say.
    """

    time_s: float
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


class HeadingReading(Struct, frozen=True, gc=False):
    """Where the bow points: radians from true north, clockwise; the rate too where the part has a gyro.

    roll_rad (positive to starboard) and pitch_rad (bow up): where the part measures them.
    """

    time_s: float
    heading_rad: float
    yaw_rate_rad_s: float | None = None
    roll_rad: float | None = None
    pitch_rad: float | None = None


class SonarReading(Struct, frozen=True, gc=False):
    """One ping. bearing_rad is relative to the bow, clockwise; range_m is None when no echo came back."""

    time_s: float
    bearing_rad: float
    range_m: float | None
    min_range_m: float = 0.02
    max_range_m: float = 4.0


class BatteryReading(Struct, frozen=True, gc=False):
    """The pack as the monitor sees it. current_a is positive while discharging, None when not measured."""

    time_s: float
    voltage_v: float
    current_a: float | None = None


class HullReading(Struct, frozen=True, gc=False):
    """How it looks inside the hull: water, and the warmest thing that is measured. None: not measured."""

    time_s: float
    is_wet: bool | None = None
    temperature_c: float | None = None


class RcReading(Struct, frozen=True, gc=False):
    """What a radio control receiver says: every channel's pulse width in µs, the first is channel 1.

    is_failsafe: the receiver itself says that it hears no transmitter; the channels are then worth nothing.
    quality: share of the transmitter's packets that arrive, 0..1; rssi_dbm: how strong they are. Both None
    where the receiver does not say.
    """

    time_s: float
    channels_us: tuple[int, ...]
    is_failsafe: bool = False
    quality: float | None = None
    rssi_dbm: float | None = None
