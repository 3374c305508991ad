"""Calibration of a magnetometer against a known iron: fits, coverage, refusals."""

import math
import random
from collections.abc import Callable

import pytest
from twins.lines import known

from companion.calibration.compass import CompassCalibration, CompassVerdict, FieldFit
from companion.calibration.ellipsoid import fit_ellipsoid
from companion.calibration.motor_field import MotorFieldCalibration, MotorFit
from companion.core.readings import HeadingReading
from companion.core.units import wrap_pi
from companion.core.vectors import Matrix, Vector, plus, times
from companion.sensors.compass.attitude import down_axis, magnetic_heading
from companion.sensors.compass.earth_field import EarthField
from companion.sensors.compass.magnetic_field import (
    BY_CURRENT,
    BY_THROTTLE,
    NO_CORRECTION,
    FieldCorrector,
    MagneticCorrection,
    MotorLoad,
)

EARTH = EarthField(0.0, 200.0, 440.0)
HARD: Vector = (160.0, -90.0, 120.0)
SOFT: Matrix = ((1.08, 0.05, 0.0), (0.05, 0.92, 0.0), (0.0, 0.0, 1.0))
PERIOD_S = 0.02


def field_at(heading_rad: float, roll_rad: float = 0.0, pitch_rad: float = 0.0) -> Vector:
    """The earth's field in body axes: yaw, then pitch, then roll."""
    x, y, z = 200.0 * math.cos(heading_rad), -200.0 * math.sin(heading_rad), 440.0
    cos, sin = math.cos(pitch_rad), math.sin(pitch_rad)
    x, z = x * cos - z * sin, x * sin + z * cos
    cos, sin = math.cos(roll_rad), math.sin(roll_rad)
    return x, y * cos + z * sin, -y * sin + z * cos


class Boat:
    """A boat with iron, whose readings go to a calibration."""

    def __init__(self, calibration: CompassCalibration, hard: Vector = HARD, soft: Matrix = SOFT) -> None:
        self.calibration = calibration
        self.hard, self.soft = hard, soft
        self.random = random.Random(1)
        self.now_s = 0.0

    def measured(self, heading_rad: float, roll_rad: float = 0.0, pitch_rad: float = 0.0) -> Vector:
        field = plus(times(self.soft, field_at(heading_rad, roll_rad, pitch_rad)), self.hard)
        return plus(field, tuple(self.random.gauss(0.0, 1.5) for _ in range(3)))  # type: ignore[arg-type]

    def hold(
        self,
        heading_rad: float,
        rate_rad_s: float | None = 0.0,
        roll_rad: float = 0.0,
        pitch_rad: float = 0.0,
    ) -> None:
        self.now_s += PERIOD_S
        field = self.measured(heading_rad, roll_rad, pitch_rad)
        reading = HeadingReading(self.now_s, 0.0, rate_rad_s, roll_rad, pitch_rad, field, is_magnetic=True)
        self.calibration.update(reading, self.now_s)

    def circle(
        self,
        turns: float = 1.3,
        rate_rad_s: float = 0.3,
        heel: Callable[[float], float] = lambda _: 0.0,
        gyro: float | None = 1.0,
    ) -> None:
        """gyro: its reading relative to the truth."""
        for step in range(round(abs(turns * 2.0 * math.pi / rate_rad_s / PERIOD_S))):
            heading = math.copysign(rate_rad_s, turns) * step * PERIOD_S
            rate = None if gyro is None else math.copysign(rate_rad_s, turns) * gyro
            self.hold(heading, rate, heel(self.now_s))

    def tumble(self) -> None:
        for step in range(3000):
            t = step * PERIOD_S
            self.hold(1.1 * t, 0.0, math.pi * math.sin(0.37 * t), 1.5 * math.sin(0.61 * t))


def worst_deg(boat: Boat, fit: FieldFit, roll_rad: float = 0.0) -> float:
    """The largest error of the corrected heading on a full circle."""
    errors = []
    for degrees in range(0, 360, 5):
        field = plus(times(boat.soft, field_at(math.radians(degrees), roll_rad)), boat.hard)
        heading = known(magnetic_heading(fit.correction.iron_corrected(field), down_axis(roll_rad, 0.0)))
        errors.append(abs(math.degrees(wrap_pi(heading - math.radians(degrees)))))
    return max(errors)


def test_a_circle_on_the_water_corrects_hard_and_soft_iron() -> None:
    boat = Boat(CompassCalibration(NO_CORRECTION, EARTH, 0.0))
    boat.circle(heel=lambda t: 0.08 * math.sin(2.0 * t))  # she rolls by 5° meanwhile
    assert boat.calibration.is_complete
    assert boat.calibration.dimensions == 2
    fit = boat.calibration.solve(16.0)
    assert fit.verdict is CompassVerdict.SUCCESS
    assert fit.fitness_mg < 12.0
    assert worst_deg(boat, fit) < 3.0
    assert worst_deg(boat, fit, math.radians(8.0)) < 6.0  # the vertical offset is from the earth's field
    assert fit.correction.offset[2] == pytest.approx(-120.0, abs=5.0)


def test_turning_in_the_hands_gives_the_ellipsoid() -> None:
    soft: Matrix = ((1.1, 0.04, -0.03), (0.04, 0.95, 0.05), (-0.03, 0.05, 0.9))
    boat = Boat(CompassCalibration(NO_CORRECTION, EARTH, 0.0), soft=soft)
    boat.tumble()
    assert boat.calibration.is_complete
    assert boat.calibration.dimensions == 3
    fit = boat.calibration.solve(16.0)
    assert fit.verdict is CompassVerdict.SUCCESS
    assert fit.correction.offset == pytest.approx((-160.0, 90.0, -120.0), abs=2.0)
    assert worst_deg(boat, fit) < 1.0
    assert worst_deg(boat, fit, math.radians(25.0)) < 1.0


@pytest.mark.parametrize("turns", [0.25, 0.5, 0.75])
def test_part_of_a_circle_is_not_enough(turns: float) -> None:
    boat = Boat(CompassCalibration(NO_CORRECTION, EARTH, 0.0))
    boat.circle(turns)
    assert not boat.calibration.is_complete
    assert boat.calibration.progress_percent < 90


@pytest.mark.parametrize(("strength", "verdict"), [(0.7, 4), (1.5, 4), (1.7, 7)])
def test_the_earths_strength_is_asked_for_within_bounds(strength: float, verdict: int) -> None:
    scale: Matrix = ((strength, 0.0, 0.0), (0.0, strength, 0.0), (0.0, 0.0, 1.0))
    boat = Boat(CompassCalibration(NO_CORRECTION, EARTH, 0.0), soft=scale)
    boat.circle()
    assert boat.calibration.solve(16.0).verdict == verdict


@pytest.mark.parametrize(("heel_deg", "dimensions"), [(15.0, 2), (25.0, 3)])
def test_a_heel_that_no_boat_on_the_water_has_asks_for_all_directions(
    heel_deg: float, dimensions: int
) -> None:
    boat = Boat(CompassCalibration(NO_CORRECTION, EARTH, 0.0))
    boat.circle(heel=lambda t: math.radians(heel_deg) * math.sin(t))
    assert boat.calibration.dimensions == dimensions
    assert boat.calibration.is_complete is (dimensions == 2)


@pytest.mark.parametrize(("gyro", "verdict"), [(0.75, 4), (1.35, 4), (0.6, 6), (1.6, 6)])
def test_the_field_turns_about_as_far_as_the_gyro(gyro: float, verdict: int) -> None:
    boat = Boat(CompassCalibration(NO_CORRECTION, EARTH, 0.0))
    boat.circle(gyro=1.0 / gyro)
    assert boat.calibration.solve(16.0).verdict == verdict


def test_what_the_motors_draw_meanwhile_is_taken_out_if_it_is_known() -> None:
    before = MagneticCorrection(motor=(-5.0, 3.0, 0.0), motor_source=BY_CURRENT)
    boat = Boat(CompassCalibration(before, EARTH, 0.0))
    boat.hard = plus(HARD, (5.0, -3.0, 0.0), 4.0)
    update = boat.calibration.update
    boat.calibration.update = lambda reading, now_s, load=None: update(reading, now_s, MotorLoad(0.5, 4.0))  # type: ignore[method-assign]
    boat.circle()
    offset = boat.calibration.solve(16.0).correction.offset
    assert offset[:2] == pytest.approx((-HARD[0], -HARD[1]), abs=2.0)


def test_an_offset_beyond_the_parameters_range_is_refused_with_the_cure() -> None:
    boat = Boat(CompassCalibration(NO_CORRECTION, EARTH, 0.0), hard=(1900.0, 0.0, 0.0))
    boat.circle()
    told = "iron or a magnet is too near: move the compass"
    assert boat.calibration.solve(16.0) == FieldFit(CompassVerdict.FAILED, told, NO_CORRECTION, 0.0, 0.0)


def test_an_arc_has_the_centre_and_radius_of_its_circle() -> None:
    arc = [(3.0 + 5.0 * math.cos(0.1 * t), -2.0 + 5.0 * math.sin(0.1 * t)) for t in range(35)]
    found = fit_ellipsoid(arc)
    assert found is not None
    assert (*found.centre, found.radius) == pytest.approx((3.0, -2.0, 5.0))


@pytest.mark.parametrize(
    "points",
    [
        [],
        [(1.0, 1.0)] * 20,
        [(float(x), 2.0 * x) for x in range(20)],
        [(float(x), float(x * x)) for x in range(9)],
    ],
)
def test_what_is_not_closed_has_no_ellipse(points: list[tuple[float, ...]]) -> None:
    assert fit_ellipsoid(points) is None


class Pier:
    """A moored boat whose motors disturb the compass, with a heading that wanders."""

    def __init__(self, before: MagneticCorrection, motor: Vector, per: str) -> None:
        self.job = MotorFieldCalibration(before, 0.0)
        self.motor, self.per = motor, per
        self.random = random.Random(2)
        self.now_s = self.heading_rad = 0.0

    def run(self, seconds: float, throttle: float, rate_rad_s: float = 0.0, has_current: bool = True) -> None:
        for _ in range(round(seconds / PERIOD_S)):
            self.now_s += PERIOD_S
            self.heading_rad += rate_rad_s * PERIOD_S
            current_a = 0.4 + 8.0 * throttle**1.7
            load = current_a if self.per == "current" else throttle
            field = plus(plus(field_at(self.heading_rad), self.motor, load), HARD)
            field = plus(field, tuple(self.random.gauss(0.0, 1.5) for _ in range(3)))  # type: ignore[arg-type]
            reading = HeadingReading(self.now_s, 0.0, rate_rad_s, 0.0, 0.0, field)
            self.job.update(reading, MotorLoad(throttle, current_a if has_current else None), self.now_s)

    def ramp(self, **arguments: bool) -> None:
        for step in range(20):
            self.run(0.5, 0.7 * step / 20.0, 0.05 if step % 4 < 2 else -0.05, **arguments)
        self.run(3.0, 0.0, **arguments)


IRON = MagneticCorrection(offset=(-HARD[0], -HARD[1], -HARD[2]))


@pytest.mark.parametrize(("per", "has_current"), [("current", True), ("throttle", False)])
def test_the_motors_field_is_found_by_current_else_by_throttle(per: str, has_current: bool) -> None:
    motor: Vector = (6.0, -9.0, 3.0) if per == "current" else (40.0, -60.0, 20.0)
    pier = Pier(IRON, motor, per)
    pier.ramp(has_current=has_current)
    assert pier.job.is_complete
    fit = pier.job.solve()
    assert not fit.reason
    assert fit.correction.motor == pytest.approx([-one for one in motor], rel=0.1, abs=0.5)
    assert fit.correction.motor_source == (BY_CURRENT if per == "current" else BY_THROTTLE)
    assert fit.correction.offset == IRON.offset
    corrector = FieldCorrector()
    corrector.correction, corrector.load = fit.correction, MotorLoad(0.7, 0.4 + 8.0 * 0.7**1.7)
    load = corrector.load.of(fit.correction.motor_source)
    heading = magnetic_heading(
        corrector.correct(plus(plus(field_at(1.0), motor, load), HARD)), (0.0, 0.0, 1.0)
    )
    assert heading == pytest.approx(1.0, abs=math.radians(1.0))


def test_a_run_without_throttle_or_with_a_turn_says_so() -> None:
    pier = Pier(IRON, (6.0, -9.0, 3.0), "current")
    pier.run(121.0, 0.2)
    assert pier.job.is_complete
    assert pier.job.solve() == MotorFit(IRON, 0.0, "the throttle stayed below 30 %")
    assert [pier.job.progress_percent(now_s) for now_s in (0.0, 60.0, 500.0)] == [0, 50, 99]
    pier = Pier(IRON, (6.0, -9.0, 3.0), "current")
    pier.run(6.0, 0.6, rate_rad_s=0.3)
    assert pier.job.solve().reason == "the boat turned too far: moor it"
