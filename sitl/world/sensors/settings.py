"""The sensors' settings: a table each of a scenario."""

from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share
from sitl.world.sensors.rangers import SonarSettings
from sitl.world.sensors.receivers import GnssSettings


class CompassSettings(Section, frozen=True):
    """A magnetic compass with a yaw gyro, clockwise positive.

    The compass is off by white noise and by the deviation that calibration has left over, after Archibald
    Smith's coefficients: a constant A (bias_deg), a semicircular part by hard iron, which turns once with the
    heading, and a quadrantal part by soft iron, which turns twice. The motors' leads act as hard iron that
    grows with their current. The *_at_deg are the headings where a part is zero and rising. declination_deg
    is the angle from true to magnetic north, east positive: the boat's configuration corrects for it as well
    as its owner knew (`vehicle.parts.compass.correction_rad`). With magnetometer_mg the compass is a bare
    one: its readings have the field, which the boat corrects by its calibration, and their north is magnetic.

    Tilt compensation takes a share of the sideways acceleration in a turn, turn_tilt_share, for a heel of the
    hull, and turns the heading by that angle times the tangent of the field's dip_deg.

    Roll and pitch are those of the hull in the waves. reports_lean: False for a part that measures only the
    heading, such as an NMEA compass.

    The gyro is off by a scale error, white noise, a fixed bias and its random walk (the deviation after a
    minute).
    """

    rate_hz: Positive = 50.0
    magnetometer_mg: NonNegative = 0.0  # the earth's horizontal field; 0: a part that calibrates itself
    noise_deg: NonNegative = 0.8
    bias_deg: float = 1.0
    hard_iron_deg: NonNegative = 0.0
    hard_iron_at_deg: float = 60.0
    soft_iron_deg: NonNegative = 0.0
    soft_iron_at_deg: float = 20.0
    motor_deg_per_a: NonNegative = 0.0
    motor_at_deg: float = -30.0
    declination_deg: Annotated[float, Meta(ge=-180.0, le=180.0)] = 0.0
    dip_deg: Annotated[float, Meta(ge=-85.0, le=85.0)] = 66.0
    turn_tilt_share: Share = 0.0
    reports_lean: bool = True
    gyro_scale: Positive = 1.0
    gyro_noise_deg_s: NonNegative = 0.3
    gyro_bias_deg_s: float = 0.1
    gyro_walk_deg_s: NonNegative = 0.0


class LidarSettings(Section, frozen=True):
    """A second ranger on another MAVLink component: a 2-D scan as OBSTACLE_DISTANCE, or one beam ahead.

    The scan has a ray every step_deg over field_deg about the bow. With field_deg 0 it is a fixed ranger of
    beam_deg, such as a TFmini, that sends DISTANCE_SENSOR. lost_share of the rays return nothing; of those
    that meet something half_range_m away, half: the light that comes back falls with the square of the
    range (20 log of it in dB), and stones and reeds differ by some 3 dB.
    """

    fitted: bool = False
    rate_hz: Annotated[float, Meta(gt=0.0, le=50.0)] = 10.0
    field_deg: Annotated[float, Meta(ge=0.0, le=355.0)] = 180.0
    step_deg: Annotated[float, Meta(ge=5.0, le=90.0)] = 5.0  # a message has 72 rays
    beam_deg: Annotated[float, Meta(gt=0.0, le=90.0)] = 3.6
    min_range_m: NonNegative = 0.2
    max_range_m: Annotated[float, Meta(gt=0.0, le=100.0)] = 12.0
    # An LD19's 12 m are on 70 % of reflection (its data sheet), 10 m on 50 %; a TFmini has 7 m outdoors
    half_range_m: Positive = 10.0
    noise_m: NonNegative = 0.03
    lost_share: Share = 0.02


class BatteryMonitorSettings(Section, frozen=True):
    """White noise on each, and a gain of the current that the shunt is off by (1 is right).

    max_current_a: beyond it the current is unknown; 0: no limit.
    """

    voltage_noise_v: NonNegative = 0.0
    current_noise_a: NonNegative = 0.0
    current_gain: NonNegative = 1.0
    max_current_a: NonNegative = 0.0


class HullSensorSettings(Section, frozen=True):
    """A probe for water and a thermometer inside the hull. temperature_c: how warm it is in there."""

    fitted: bool = True
    temperature_c: Annotated[float, Meta(ge=-40.0, le=85.0)] = 40.0


class DepthSettings(Section, frozen=True):
    """A depth sounder as the Ping1D. The bottom is that of the scenario's environment.

    Its noise has a fixed part and a share of the depth. sound_gain: what depths are off by where the speed of
    sound is set wrongly. lost_share of the soundings find no bottom, and in waves bubble_share_per_m of their
    height more (an estimate: air under the hull). double_share of them are the second echo, by way of the
    surface; over weed, weed_echo_share come from the plants. latency_s: until a sounding arrives. Raises
    ValueError: a latency as long as the interval of the soundings.
    """

    fitted: bool = False
    rate_hz: Positive = 5.0
    beam_deg: Annotated[float, Meta(ge=0.0, le=60.0)] = 30.0  # Ping1D, −3 dB; Ping2 25
    noise_m: NonNegative = 0.02
    noise_share: NonNegative = 0.005  # its data sheet: resolution of 0.5 % of the range
    sound_gain: Positive = 1.0096  # 1480 m/s is assumed; fresh water of 15 °C has 1466 (Bilaniuk and Wong)
    lost_share: Share = 0.02
    bubble_share_per_m: NonNegative = 0.5
    double_share: Share = 0.005
    weed_echo_share: Share = 0.7
    latency_s: NonNegative = 0.12  # the boat assumes 0.1
    transducer_m: NonNegative = 0.1
    forward_m: float = 0.0  # the transducer's place from the GNSS antenna
    starboard_m: float = 0.0
    min_range_m: NonNegative = 0.3
    max_range_m: Positive = 50.0
    temperature_c: Annotated[float, Meta(ge=-5.0, le=50.0)] = 15.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.latency_s * self.rate_hz >= 1.0:
            raise ValueError(f"latency_s = {self.latency_s:g}: expected less than 1 / rate_hz")


class AisSettings(Section, frozen=True):
    """An AIS receiver. noise_m: of the vessels' positions, on each axis; lost_share: of their reports."""

    fitted: bool = False
    noise_m: NonNegative = 3.0  # of a receiver without corrections, as `GnssSettings` has it in all
    lost_share: Share = 0.1


class StickStep(Section, frozen=True):
    """Where sticks and switches are from a time on: every channel's pulse in µs. None: it is off."""

    at_s: NonNegative = 0.0
    channels: Annotated[tuple[Annotated[int, Meta(ge=500, le=2500)], ...], Meta(max_length=18)] = ()


class RcSettings(Section, frozen=True):
    """A radio control receiver, and what the hand on its transmitter does, step by step.

    Until the first of them everything is in the middle. The transmitter stays where the boat begins. quality:
    share of the frames that arrive, 0..1, as far as half of range_m; from there on it falls, to nothing at
    range_m, where the receiver's own failsafe begins. rssi_dbm: at 10 m, in free space.
    """

    fitted: bool = False
    rate_hz: Positive = 50.0
    noise_us: NonNegative = 1.0
    quality: Share = 1.0
    rssi_dbm: float = -60.0
    range_m: NonNegative = 0.0  # 0: without end
    sticks: tuple[StickStep, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        times_s = [step.at_s for step in self.sticks]
        if times_s != sorted(times_s):
            raise ValueError(f"sticks at {times_s} s: expected their times in order")


class Sensors(Section, frozen=True):
    """The sensors aboard."""

    gnss: GnssSettings = GnssSettings()
    compass: CompassSettings = CompassSettings()
    sonar: SonarSettings = SonarSettings()
    lidar: LidarSettings = LidarSettings()
    battery: BatteryMonitorSettings = BatteryMonitorSettings()
    rc: RcSettings = RcSettings()
    hull: HullSensorSettings = HullSensorSettings()
    depth: DepthSettings = DepthSettings()
    ais: AisSettings = AisSettings()
