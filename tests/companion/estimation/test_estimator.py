"""The estimator against motions that are known exactly, and against readings that are not to be believed."""

import math
import random
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.readings import GnssFix, HeadingReading
from companion.core.state import EstimateFault
from companion.estimation.covariance import HEADING
from companion.estimation.estimator import Estimator

ORIGIN = LatLon(50.0, -1.2)
FRAME = LocalFrame(ORIGIN)


HERE = Point(0.0, 0.0)


def _fix(time_s: float, at: Point = HERE, velocity: tuple[float, float] | None = None) -> GnssFix:
    north, east = velocity or (None, None)
    return GnssFix(time_s, FRAME.to_global(at), 3, 12, 0.9, north, east, horizontal_accuracy_m=0.25)


def test_the_frame_is_laid_at_the_first_good_fix_and_stays_there() -> None:
    estimator = Estimator()
    assert estimator.update(replace(_fix(0.1), fix_type=2), None, 0.2) is None
    estimator.update(_fix(0.3, Point(5.0, 0.0)), None, 0.4)
    estimator.update(_fix(0.5, Point(9.0, 0.0)), None, 0.6)
    assert estimator.frame is not None
    assert FRAME.to_local(estimator.frame.origin) == pytest.approx((5.0, 0.0), abs=1e-3)
    assert estimator.report is not None
    assert not estimator.report.compass.is_accepted


def test_what_is_not_known_yet_is_infinitely_old() -> None:
    nav = Estimator().update(None, HeadingReading(1.0, 0.5), 1.5)
    assert nav is not None
    assert nav.position_age_s == math.inf
    assert nav.heading_age_s == pytest.approx(0.5)
    nav = Estimator().update(_fix(1.0), None, 1.5)
    assert nav is not None
    assert nav.position_age_s == pytest.approx(0.5)
    assert nav.heading_age_s == math.inf


def test_dead_reckoning_ends_before_it_runs_away() -> None:
    estimator = Estimator()
    estimator.update(_fix(0.0, Point(0.0, 0.0), (2.0, 0.0)), None, 0.0)
    nav = estimator.update(None, None, 600.0)
    assert nav is not None
    assert nav.north_m < 6.5
    assert nav.position_age_s == 600.0
    assert nav.faults & EstimateFault.POSITION_LOST


@pytest.mark.parametrize(
    "bad",
    [
        replace(_fix(5.0, Point(50.0, 0.0)), north_m_s=math.nan, east_m_s=0.0),
        replace(_fix(5.0, Point(50.0, 0.0)), horizontal_accuracy_m=math.nan),
        replace(_fix(5.0, Point(50.0, 0.0)), horizontal_accuracy_m=None, hdop=math.inf),
        replace(_fix(5.0, Point(50.0, 0.0)), horizontal_accuracy_m=1e300),
        replace(_fix(5.0, Point(50.0, 0.0)), north_m_s=1e300, east_m_s=0.0),
        replace(_fix(5.0, Point(50.0, 0.0)), fix_type=1),
        replace(_fix(5.0, Point(50.0, 0.0)), time_s=math.nan),
        _fix(0.5, Point(50.0, 0.0)),  # older than what is known
        GnssFix(5.0, LatLon(-33.9, 151.2), 3, 12, 0.8),  # on another continent
        _fix(99.0, Point(50.0, 0.0)),  # from the future
    ],
)
def test_a_bad_fix_ages_the_estimate_and_moves_nothing(bad: GnssFix) -> None:
    estimator = Estimator()
    estimator.update(_fix(1.0), None, 1.0)
    nav = estimator.update(bad, None, 6.0)
    assert nav is not None
    assert nav.point == pytest.approx((0.0, 0.0))
    assert nav.position_age_s == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("time_s", "accuracy_m", "speed_m_s", "is_used"),
    [
        (-9.9, 999.0, 99.0, True),
        (-10.1, 1.0, 0.0, False),
        (0.0, 1001.0, 0.0, False),
        (0.0, 1.0, 101.0, False),
    ],
)
def test_a_fix_is_used_within_the_limits_of_age_accuracy_and_speed(
    time_s: float, accuracy_m: float, speed_m_s: float, is_used: bool
) -> None:
    estimator = Estimator()
    fix = replace(_fix(time_s, velocity=(0.0, speed_m_s)), horizontal_accuracy_m=accuracy_m)
    estimator.update(fix, None, 0.0)
    assert (estimator.frame is not None) is is_used


@pytest.mark.parametrize(
    "bad",
    [HeadingReading(2.0, math.nan), HeadingReading(2.0, 1.0, math.inf), HeadingReading(math.nan, 1.0)],
)
def test_a_bad_heading_ages_the_estimate_and_turns_nothing(bad: HeadingReading) -> None:
    estimator = Estimator()
    estimator.update(None, HeadingReading(1.0, 0.5), 1.0)
    nav = estimator.update(None, bad, 2.0)
    assert nav is not None
    assert nav.heading_rad == pytest.approx(0.5)
    assert nav.heading_age_s == 1.0


wild = st.floats(allow_nan=True, allow_infinity=True)
fixes = st.builds(
    GnssFix,
    time_s=wild | st.floats(0.0, 20.0),
    position=st.builds(LatLon, st.floats(-85.0, 85.0), st.floats(-180.0, 180.0)),
    fix_type=st.integers(0, 6),
    satellites=st.integers(0, 30),
    hdop=wild,
    north_m_s=st.none() | wild,
    east_m_s=st.none() | wild,
    horizontal_accuracy_m=st.none() | wild,
)
headings = st.builds(
    HeadingReading,
    time_s=wild | st.floats(0.0, 20.0),
    heading_rad=wild,
    yaw_rate_rad_s=st.none() | wild,
)


@given(st.lists(st.tuples(st.none() | fixes, st.none() | headings), max_size=30))
def test_the_estimate_stays_finite_for_any_readings(
    readings: list[tuple[GnssFix | None, HeadingReading | None]],
) -> None:
    estimator = Estimator()
    for tick, (fix, heading) in enumerate(readings):
        nav = estimator.update(fix, heading, tick * 0.5)
        if nav is None:
            continue
        motion = (nav.north_m, nav.east_m, nav.heading_rad, nav.yaw_rate_rad_s, nav.surge_m_s, nav.sway_m_s)
        assert all(math.isfinite(value) for value in motion)
        assert nav.position_age_s >= 0.0
        assert nav.heading_age_s >= 0.0


def test_a_frame_chosen_on_another_continent_is_not_laid() -> None:
    estimator, fix = Estimator(), GnssFix(0.0, LatLon(50.0, -1.2), 3, 12, 0.8)
    estimator.preset_frame = LocalFrame(LatLon(73.9, -166.7))
    nav = estimator.update(fix, None, 0.0)
    assert nav is not None
    assert estimator.frame is not None
    assert estimator.frame.origin == fix.position
    assert (nav.north_m, nav.east_m) == pytest.approx((0.0, 0.0), abs=1e-6)


def test_an_origin_that_fixes_have_left_for_seconds_may_be_laid_anew() -> None:
    estimator, far = Estimator(), LatLon(51.2, -1.2)  # 133 km
    for tick in range(20):
        estimator.update(GnssFix(0.2 * tick, ORIGIN, 3, 12, 0.8), None, 0.2 * tick)
    estimator.update(GnssFix(4.0, far, 3, 12, 0.8), None, 4.0)
    assert estimator.far_m == 0.0, "one fix may be wrong"
    estimator.update(GnssFix(4.2, ORIGIN, 3, 12, 0.8), None, 4.2)
    times_s = [4.4 + 0.2 * tick for tick in range(20)]
    heard = []
    for time_s in times_s:
        estimator.update(GnssFix(time_s, far, 3, 12, 0.8), None, time_s)
        heard.append(estimator.far_m)
    assert heard[:14] == [0.0] * 14
    assert heard[-1] == pytest.approx(133_500.0, rel=0.01)
    estimator.reset_origin()
    nav = estimator.update(GnssFix(9.0, far, 3, 12, 0.8), None, 9.0)
    assert nav is not None
    assert nav.position_age_s == 0.0
    assert estimator.frame is not None
    assert estimator.frame.origin == far
    assert estimator.far_m == 0.0


@pytest.mark.parametrize(
    ("rate", "fault"),
    [
        (lambda tick: 0.01 + 0.001 * (tick % 3), EstimateFault(0)),
        (lambda tick: 0.01 + 0.001 * (tick % 3) if tick < 100 else None, EstimateFault.GYRO_LOST),
        (lambda _: None, EstimateFault(0)),  # a part without one
        (lambda tick: 0.087 + 0.001 * (tick % 3), EstimateFault.GYRO_OFF),
    ],
    ids=["good", "silent", "none fitted", "biased"],
)
def test_a_gyro_that_fails_beside_a_good_compass_is_told(
    rate: Callable[[int], float | None], fault: EstimateFault
) -> None:
    estimator = Estimator()
    for tick in range(3000):
        reading = HeadingReading(0.02 * tick, 0.001 * (tick % 7), rate(tick))
        nav = estimator.update(None, reading, 0.02 * tick)
        if fault is EstimateFault.GYRO_LOST and nav is not None:
            assert bool(nav.faults & fault) is (tick > 100 + 76) or 170 < tick < 185
    assert nav is not None
    assert EstimateFault(nav.faults) & (EstimateFault.GYRO_LOST | EstimateFault.GYRO_OFF) == fault


@pytest.mark.parametrize("seed", [1, 2])
def test_at_rest_without_a_compass_coloured_velocities_tell_no_heading(seed: int) -> None:
    rng, estimator, lasts = random.Random(seed), Estimator(), math.exp(-0.2)
    step, velocity = 0.08 * math.sqrt(1.0 - lasts * lasts), 0j
    for tick in range(1, 6000):
        now_s, fix = 0.02 * tick, None
        if tick % 10 == 0:
            velocity = lasts * velocity + complex(rng.gauss(0.0, step), rng.gauss(0.0, step))
            at = Point(rng.gauss(0.0, 0.1), rng.gauss(0.0, 0.1))
            north, east = velocity.real, velocity.imag
            fix = GnssFix(now_s, FRAME.to_global(at), 3, 12, 0.9, north, east, horizontal_accuracy_m=1.1)
        estimator.update(fix, HeadingReading(now_s, math.nan, rng.gauss(0.0, 0.005)), now_s)
    assert estimator.heading.is_blind
    assert math.sqrt(estimator.state.covariance.variance(HEADING)) > 0.9
