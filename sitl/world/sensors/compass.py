"""The magnetic compass with its yaw gyro."""

import math
from collections.abc import Callable

import msgspec

from companion.core.readings import HeadingReading
from companion.core.units import wrap_pi
from companion.core.vectors import Vector
from companion.sensors.compass.attitude import down_axis, magnetic_heading
from companion.sensors.compass.magnetic_field import FieldCorrector
from sitl.world.sampling import NORMAL, NORMALS, TIME_SLACK_S, generator
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.sensor import Sensor
from sitl.world.sensors.settings import CompassSettings

_GRAVITY_M_S2 = 9.81
_FULL_ANGLE_RAD = math.radians(2048.0)  # of 16 bits at 1/16°, as of a BNO055,
_FULL_RATE_RAD_S = math.radians(2048.0)  # and 1/16°/s
_ANGLES = ("heading_rad", "roll_rad", "pitch_rad")
_SLOW_S = 0.1  # deviation and bias change with the heading and the minutes, not from sample to sample


class SimCompass(Sensor[HeadingReading]):
    """Compass and gyro, read once per period. They fail apart: `fault` is the compass's."""

    def __init__(self, settings: CompassSettings, seed: int, correction_rad: float = 0.0) -> None:
        """Start without a reading. correction_rad: what the boat's configuration adds to every heading."""
        super().__init__()
        self.gyro_fault: SensorFault[HeadingReading] | None = None
        radians = math.radians
        self._random = generator(seed, "compass")
        self._rate_hz = settings.rate_hz
        self._reports_lean = settings.reports_lean
        self._noise_rad = radians(settings.noise_deg)
        self._bias_rad = radians(settings.bias_deg - settings.declination_deg) + correction_rad
        self._hard_rad, self._hard_at_rad = (
            radians(settings.hard_iron_deg),
            radians(settings.hard_iron_at_deg),
        )
        self._soft_rad, self._soft_at_rad = (
            radians(settings.soft_iron_deg),
            radians(settings.soft_iron_at_deg),
        )
        self._motor_rad_per_a = radians(settings.motor_deg_per_a)
        self._motor_at_rad = radians(settings.motor_at_deg)
        self.corrector: FieldCorrector | None = None
        self._field: BodyField | None = None
        if settings.magnetometer_mg:
            self.corrector = FieldCorrector()
            self._field = BodyField(settings, lambda: NORMAL[int(NORMALS * self._random.random())])
            self._bias_rad = radians(settings.bias_deg) + correction_rad
        self._is_magnetic = bool(self._hard_rad or self._soft_rad or self._motor_rad_per_a)
        # Heading error on a northerly course, per m/s² to starboard
        self._tilt_rad_s2_m = settings.turn_tilt_share * math.tan(radians(settings.dip_deg)) / _GRAVITY_M_S2
        self._gyro_scale = settings.gyro_scale
        self._gyro_noise = radians(settings.gyro_noise_deg_s)
        self._gyro_bias = radians(settings.gyro_bias_deg_s)
        self._gyro_walk = radians(settings.gyro_walk_deg_s) * math.sqrt(
            max(_SLOW_S, 1.0 / settings.rate_hz) / 60.0
        )
        self._deviation_rad = 0.0
        self._slow_due_s = 0.0

    def sample(
        self,
        now_s: float,
        heading_rad: float,
        yaw_rate_rad_s: float,
        motor_current_a: float = 0.0,
        surge_m_s: float = 0.0,
        lean: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Sample when due. lean: roll and pitch in rad."""
        if not self._is_due(now_s, self._rate_hz):
            return
        random = self._random.random
        if now_s >= self._slow_due_s:
            self._slow_due_s = now_s + _SLOW_S - TIME_SLACK_S
            self._deviation_rad = self._deviation(heading_rad, motor_current_a) if self._is_magnetic else 0.0
            if self._gyro_walk:
                self._gyro_bias += self._gyro_walk * NORMAL[int(NORMALS * random())]
        heard_rad = heading_rad + self._bias_rad + self._deviation_rad
        if self._tilt_rad_s2_m:
            # In a turn to starboard the accelerometer reports a heel to port. Compensating for a heel that is
            # not there mixes the field's vertical part into the starboard axis.
            heard_rad -= self._tilt_rad_s2_m * surge_m_s * yaw_rate_rad_s * math.cos(heading_rad)
        reading = HeadingReading(
            now_s + self.clock_offset_s,
            wrap_pi(heard_rad + self._noise_rad * NORMAL[int(NORMALS * random())]),
            self._gyro_scale * yaw_rate_rad_s
            + self._gyro_bias
            + self._gyro_noise * NORMAL[int(NORMALS * random())],
            lean[0] if self._reports_lean else None,
            lean[1] if self._reports_lean else None,
        )
        if self._field is not None and self.corrector is not None:
            field = self._field.at(heading_rad, motor_current_a)
            field = body_axes(field, *lean)
            reading = self._of_field(reading, field, self.corrector.correct(field), lean)
        if self.fault is None and self.gyro_fault is None:
            self._latest = self._sampled = reading
        else:
            faulty = self._with_faults(reading, now_s)
            if faulty is not None:
                self._latest = faulty

    def _of_field(
        self, reading: HeadingReading, measured: Vector, corrected: Vector, lean: tuple[float, float]
    ) -> HeadingReading:
        """The reading of a bare magnetometer, its tilt known."""
        heading_rad = magnetic_heading(corrected, down_axis(*lean)) or 0.0
        return msgspec.structs.replace(
            reading,
            heading_rad=wrap_pi(heading_rad + self._bias_rad),
            roll_rad=lean[0],
            pitch_rad=lean[1],
            field_mg=measured,
            is_magnetic=True,
        )

    def _deviation(self, heading_rad: float, motor_current_a: float) -> float:
        sin = math.sin
        return (
            self._hard_rad * sin(heading_rad - self._hard_at_rad)
            + self._soft_rad * sin(2.0 * (heading_rad - self._soft_at_rad))
            + self._motor_rad_per_a * motor_current_a * sin(heading_rad - self._motor_at_rad)
        )

    def _with_faults(self, reading: HeadingReading, now_s: float) -> HeadingReading | None:
        faulty: HeadingReading | None = reading
        if self.gyro_fault is not None:
            faulty = self._faulty_rate(reading, self.gyro_fault)
        if self.fault is not None and faulty is not None:
            faulty = self._faulty_heading(faulty, self.fault, now_s)
        return faulty

    def _faulty_rate(self, reading: HeadingReading, fault: SensorFault[HeadingReading]) -> HeadingReading:
        size_rad_s, rate = math.radians(fault.size), reading.yaw_rate_rad_s or 0.0
        heard: float | None = rate
        match fault.kind:
            case "off":
                heard = None
            case "stuck":
                held = fault.hold(self._sampled, reading)
                heard = held.yaw_rate_rad_s
            case "corrupt":
                heard = fault.corrupt(reading, yaw_rate_rad_s=_FULL_RATE_RAD_S).yaw_rate_rad_s
            case "garbage":
                heard = fault.random.uniform(-size_rad_s, size_rad_s)
            case _:
                heard = rate + size_rad_s
        return msgspec.structs.replace(reading, yaw_rate_rad_s=heard)

    def _faulty_heading(
        self, reading: HeadingReading, fault: SensorFault[HeadingReading], now_s: float
    ) -> HeadingReading | None:
        replace, heading_rad = msgspec.structs.replace, reading.heading_rad
        match fault.kind:
            case "stuck":
                held = fault.hold(self._sampled, reading)
                return replace(reading, heading_rad=held.heading_rad)
            case "garbage":
                return replace(reading, heading_rad=fault.random.uniform(-math.pi, math.pi))
            case "corrupt":
                angles = dict.fromkeys(
                    (name for name in _ANGLES if getattr(reading, name) is not None), _FULL_ANGLE_RAD
                )
                return fault.corrupt(reading, **angles)
            case "wrong":
                return replace(reading, heading_rad=wrap_pi(heading_rad + math.radians(fault.size)))
            case "drift":
                off_rad = math.radians(fault.size) * (now_s - fault.since_s)
                return replace(reading, heading_rad=wrap_pi(heading_rad + off_rad))
            case _:
                return fault.output_at(reading, now_s)


class BodyField:
    """The field at a magnetometer, of the same iron as the angles of `CompassSettings`. noise: of
    deviation 1.

    To first order in A, a deviation of A sin(ψ − α) is that of a hard iron field of −A cos α ahead and
    A sin α to starboard, and one of A sin 2(ψ − α) that of a soft iron matrix with −A cos 2α and A cos 2α
    added to its diagonal and A sin 2α beside it, as shares of the horizontal field.
    """

    def __init__(self, settings: CompassSettings, noise: Callable[[], float]) -> None:
        self._noise = noise
        self._horizontal_mg = settings.magnetometer_mg
        self._noise_mg = self._horizontal_mg * math.radians(settings.noise_deg)
        self._down_mg = self._horizontal_mg * math.tan(math.radians(settings.dip_deg))
        self._declination_rad = math.radians(settings.declination_deg)
        self._hard = _hard(settings.hard_iron_deg, settings.hard_iron_at_deg)
        self._motor = _hard(settings.motor_deg_per_a, settings.motor_at_deg)
        soft_rad, at_rad = math.radians(settings.soft_iron_deg), math.radians(settings.soft_iron_at_deg)
        self._soft = -soft_rad * math.cos(2.0 * at_rad), soft_rad * math.sin(2.0 * at_rad)

    def at(self, heading_rad: float, motor_current_a: float) -> Vector:
        """In mG; heading_rad from true north."""
        magnetic_rad = heading_rad - self._declination_rad
        cos, sin = math.cos(magnetic_rad), math.sin(magnetic_rad)
        p, q = self._soft
        ahead = (1.0 + p) * cos - q * sin + self._hard[0] + motor_current_a * self._motor[0]
        aside = q * cos - (1.0 - p) * sin + self._hard[1] + motor_current_a * self._motor[1]
        return (
            self._horizontal_mg * ahead + self._noise_mg * self._noise(),
            self._horizontal_mg * aside + self._noise_mg * self._noise(),
            self._down_mg + self._noise_mg * self._noise(),
        )


def body_axes(level: Vector, roll_rad: float, pitch_rad: float) -> Vector:
    """A vector of level axes (ahead, to starboard, down) in those of a boat that leans."""
    if roll_rad == pitch_rad == 0.0:
        return level
    ahead, aside, down = level
    cos, sin = math.cos(pitch_rad), math.sin(pitch_rad)
    ahead, down = ahead * cos - down * sin, ahead * sin + down * cos
    cos, sin = math.cos(roll_rad), math.sin(roll_rad)
    return ahead, aside * cos + down * sin, down * cos - aside * sin


def _hard(size_deg: float, at_deg: float) -> tuple[float, float]:
    size, at_rad = math.radians(size_deg), math.radians(at_deg)
    return -size * math.cos(at_rad), size * math.sin(at_rad)
