"""North, port and the clock are not special: a voyage is estimated the same in another frame.

The voyages have all that the estimator treats by itself: turns, a current, motors weaker than configured,
and sensors that stop, drift, jump or become late.
"""

import cmath
import math
import random
from typing import NamedTuple

import pytest

from companion.config.actuators import Handling
from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.readings import GnssFix, HeadingReading
from companion.core.state import EstimateFault, MotorCommand
from companion.core.units import wrap_pi
from companion.estimation.estimator import Estimator
from companion.estimation.hull_model import SurgeModel

FRAME = LocalFrame(LatLon(50.0, -1.2))
TICK_S = 1.0 / 64.0  # times are exact in binary, so comparisons with them do not depend on the clock's start
BEGINS_S = 45.0  # of the trouble, on a straight part
LATE = 77  # ticks: 1.2 s


class View(NamedTuple):
    """turn_rad: of the axes; side: −1 exchanges port and starboard; start_s: of the clock."""

    turn_rad: float = 0.0
    side: int = 1
    start_s: float = 128.0

    def of(self, vector: complex) -> complex:
        """A vector as seen in this view."""
        return cmath.rect(1.0, self.turn_rad) * complex(vector.real, self.side * vector.imag)

    def back(self, north: float, east: float) -> complex:
        """A vector of this view as seen in the plain one."""
        vector = complex(north, east) * cmath.rect(1.0, -self.turn_rad)
        return complex(vector.real, self.side * vector.imag)


class Moment(NamedTuple):
    """An estimate as seen in the plain view, and its errors."""

    numbers: tuple[float, ...]
    faults: EstimateFault
    off_m: float
    off_rad: float


def voyage(view: View, trouble: str, seconds: float) -> list[Moment]:
    """The estimates since the trouble has begun."""
    rng, estimator, hull, log = random.Random(8), Estimator(), SurgeModel(2.0, 0.6, 3.0), []
    estimator.preset_frame = FRAME
    at, heading, rate, surge = 0j, 0.4, 0.0, 0.0
    fixes: dict[int, GnssFix] = {}
    readings: dict[int, HeadingReading] = {}
    for tick in range(1, round((BEGINS_S + seconds) / TICK_S)):
        since_s, now_s = TICK_S * tick - BEGINS_S, view.start_s + TICK_S * tick
        present = trouble if since_s > 0.0 else ""
        wanted = 0.3 if tick % 1200 < 250 else -0.25 if tick % 1200 > 900 else 0.0
        rate += TICK_S / 0.8 * (wanted - rate)
        heading += rate * TICK_S
        steer = wanted / (1.2 * Handling().turn_rate_rad_s)
        surge = hull.advance(surge, rate, 0.6 + steer, 0.6 - steer, 0.9, TICK_S)
        velocity = complex(surge, hull.sway_m_s) * cmath.rect(1.0, heading) + 0.3 - 0.2j
        at += velocity * TICK_S
        noise = [rng.gauss(0.0, 1.0) for _ in range(6)]
        compass, gyro = heading + 0.01 * noise[0], view.side * (rate + 0.01 + 0.004 * noise[1])
        fix_m, ground = at + 0.1 * complex(*noise[2:4]), velocity + 0.03 * complex(*noise[4:])
        if present == "the compass drifts":
            compass += 0.05 * since_s
        elif present == "positions drift":
            fix_m += 0.4j * since_s
        elif present == "positions jump":
            fix_m += 8.0
        angle = wrap_pi(view.side * compass + view.turn_rad)
        arrives = tick + LATE * (present == "readings come late")
        if present != "the compass is off":
            has_gyro = present != "the gyro is off"
            arrives_s = view.start_s + TICK_S * arrives
            readings[arrives] = HeadingReading(arrives_s, angle, gyro if has_gyro else None)
        if tick % 13 == 0 and present != "GNSS is off":
            arrives = tick + LATE * (present == "fixes come late")
            fix_m, ground = view.of(fix_m), view.of(ground)
            place = FRAME.to_global(Point(fix_m.real, fix_m.imag))
            arrives_s = view.start_s + TICK_S * arrives
            fixes[arrives] = GnssFix(
                arrives_s, place, 5, 12, 0.9, ground.real, ground.imag, 0.0, 0.3, reset_counter=1
            )
        command = MotorCommand(0.6 + view.side * steer, 0.6 - view.side * steer)
        nav = estimator.update(fixes.pop(tick, None), readings.pop(tick, None), now_s, command)
        if since_s > 0.0 and tick % 10 == 0:
            assert nav is not None
            here = view.back(nav.north_m, nav.east_m)
            way, current = (
                view.back(nav.north_m_s, nav.east_m_s),
                view.back(nav.current_north_m_s, nav.current_east_m_s),
            )
            off_rad = wrap_pi(view.side * (nav.heading_rad - view.turn_rad) - heading)
            numbers = (
                here.real, here.imag, way.real, way.imag, current.real, current.imag, off_rad,
                view.side * nav.yaw_rate_rad_s, nav.surge_m_s, view.side * nav.sway_m_s,
                nav.position_sigma_m, nav.position_age_s, nav.heading_age_s,
            )  # fmt: skip
            log.append(Moment(numbers, EstimateFault(nav.faults), abs(here - at), abs(off_rad)))
    return log


@pytest.mark.parametrize(
    ("trouble", "fault", "off_m", "off_deg"),
    [
        ("none", EstimateFault(0), 0.3, 2.7),
        ("the compass drifts", EstimateFault.COMPASS_OFF, 0.3, 5.0),
        ("the compass is off", EstimateFault.COMPASS_LOST, 0.3, 9.0),
        ("the gyro is off", EstimateFault.GYRO_LOST, 0.3, 3.3),
        ("positions drift", EstimateFault.GNSS_JUMPING, 0.5, 3.0),
        ("positions jump", EstimateFault.GNSS_JUMPING, 0.3, 2.7),
        ("GNSS is off", EstimateFault.GNSS_LOST, 0.4, 3.0),
        ("fixes come late", EstimateFault.GNSS_JUMPING | EstimateFault.GNSS_LATE, 0.8, 5.0),
        ("readings come late", EstimateFault.COMPASS_LATE, 0.3, 30.0),
    ],
)
def test_a_voyage_is_estimated_well_and_the_same_in_another_frame(
    trouble: str, fault: EstimateFault, off_m: float, off_deg: float
) -> None:
    seconds = 50.0 if trouble == "readings come late" else 20.0  # a delay shows in turns only
    log = voyage(View(), trouble, seconds)
    # Noises adapt to the variance of north, and of east given north: in other axes these differ a little
    for one, same in zip(log, voyage(View(2.0, -1, 4096.0), trouble, seconds), strict=True):
        assert same.numbers == pytest.approx(one.numbers, abs=8e-3)
        assert same.faults == one.faults
    faults = EstimateFault(0)
    for moment in log:
        faults |= moment.faults
    assert faults == fault
    assert max(moment.off_m for moment in log) < off_m
    assert max(moment.off_rad for moment in log) < math.radians(off_deg)
    assert max(moment.off_rad for moment in log[-100:]) < math.radians(10.0)
