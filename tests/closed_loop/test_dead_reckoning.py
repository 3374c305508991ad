"""What the boat believes of itself while a sensor lies, against the truth."""

import math
from dataclasses import dataclass

import pytest
from boat_rig import RTK, STANDALONE, Rig, waypoint

from companion.core.state import EstimateFault, NavState

CURRENT = ("environment.current_m_s=0.5", "environment.current_to_deg=90.0")
AT_S = 20.0


@dataclass
class Passage:
    """A boat under way north, a fault from AT_S on. first_s: how long each bit of EstimateFault took."""

    rig: Rig
    first_s: dict[EstimateFault, float]
    error_m: float = 0.0
    heading_error_rad: float = 0.0

    def sail(self, seconds: float) -> NavState:
        """Go on; error_m and heading_error_rad keep the largest of the stretch."""
        nav = None
        self.error_m = self.heading_error_rad = 0.0
        for _ in range(round(seconds / 0.1)):
            truth = self.rig.world.truth
            self.rig.step()
            nav = self.rig.boat.nav
            assert nav is not None
            self.error_m = max(self.error_m, self.position_error_m(nav, truth.north_m, truth.east_m))
            off_rad = math.remainder(nav.heading_rad - truth.heading_rad, 2.0 * math.pi)
            self.heading_error_rad = max(self.heading_error_rad, abs(off_rad))
            for fault in EstimateFault:
                if nav.faults & fault:
                    self.first_s.setdefault(fault, self.rig.now_s - AT_S)
            self.rig.step(4)
        assert nav is not None
        return nav

    def position_error_m(self, nav: NavState, north_m: float, east_m: float) -> float:
        """How far from the truth the estimate is."""
        frame = self.rig.boat.estimator.frame
        assert frame is not None
        there = self.rig.scenario.frame.to_local(frame.to_global(nav.point))
        return math.hypot(there.north_m - north_m, there.east_m - east_m)


def under_way(
    fault: str, *settings: str, course: tuple[tuple[float, float], ...] = ((400.0, 0.0),)
) -> Passage:
    """Sailing until just before the fault, with nothing wrong so far."""
    rig = Rig("open", *CURRENT, f"faults=[{{{fault}, at_s={AT_S}}}]", *settings)
    rig.sail(*[waypoint(north_m, east_m) for north_m, east_m in course])
    passage = Passage(rig, {})
    passage.sail(AT_S - rig.now_s - 0.2)
    assert not passage.first_s, "nothing is wrong yet"
    return passage


def square(side_m: float) -> tuple[tuple[float, float], ...]:
    return ((side_m, 0.0), (side_m, side_m), (0.0, side_m), (0.0, 0.0))


def test_a_minute_without_satellites_costs_less_than_four_percent_of_the_way() -> None:
    passage = under_way("what='gnss', kind='off'", course=square(40.0))
    before = passage.sail(0.1)
    nav = passage.sail(54.0)
    assert passage.error_m < 0.04 * 2.0 * 54.0 + 1.0
    assert passage.first_s[EstimateFault.GNSS_LOST] < 2.0
    assert EstimateFault.POSITION_LOST not in passage.first_s
    assert nav.position_sigma_m > 2.0 * before.position_sigma_m
    assert nav.position_sigma_m > 0.5 * passage.error_m
    passage.sail(9.0)
    assert 54.0 < passage.first_s[EstimateFault.POSITION_LOST] < 63.0


@pytest.mark.parametrize(
    ("fault", "bit"),
    [
        ("kind='stuck'", EstimateFault.GNSS_FROZEN),
        ("kind='garbage', size=50.0", EstimateFault.GNSS_JUMPING),
    ],
)
def test_a_receiver_that_freezes_or_leaps_is_found_out_and_leads_nobody_astray(
    fault: str, bit: EstimateFault
) -> None:
    passage = under_way(f"what='gnss', {fault}, for_s=15.0")
    passage.sail(15.0)
    assert passage.first_s[bit] < 2.0
    assert passage.error_m < 2.0
    passage.sail(5.0)
    assert not passage.sail(5.0).faults, "and trusted again once it is well"


@pytest.mark.parametrize("receiver", [RTK, STANDALONE])
def test_a_receiver_that_is_jammed_is_called_noisy_and_then_lost(receiver: str) -> None:
    passage = under_way("what='gnss', kind='jammed', for_s=15.0", receiver, course=square(30.0))
    before = passage.error_m
    passage.sail(15.0)
    noisy_s, lost_s = passage.first_s[EstimateFault.GNSS_NOISY], passage.first_s[EstimateFault.GNSS_LOST]
    assert noisy_s < 5.0 < lost_s < 7.0
    assert set(passage.first_s) == {EstimateFault.GNSS_NOISY, EstimateFault.GNSS_LOST}, (
        "the position is known"
    )
    assert passage.error_m < before + 1.5
    passage.sail(10.0)
    assert not passage.sail(5.0).faults


@pytest.mark.parametrize(("speed_m_s", "seconds", "off_m"), [(0.5, 8.0, 3.0), (0.1, 35.0, 5.0)])
def test_positions_that_creep_away_from_their_velocities_are_noticed(
    speed_m_s: float, seconds: float, off_m: float
) -> None:
    passage = under_way(f"what='gnss', kind='drift', size={speed_m_s}")
    passage.sail(seconds + 5.0)
    assert passage.first_s[EstimateFault.GNSS_JUMPING] < seconds
    assert passage.error_m < off_m


@pytest.mark.parametrize(
    ("fault", "bit"),
    [
        ("kind='stuck'", EstimateFault.COMPASS_FROZEN),
        ("kind='wrong', size=45.0", EstimateFault.COMPASS_OFF),
        ("kind='garbage'", EstimateFault.COMPASS_OFF | EstimateFault.COMPASS_LOST),
    ],
)
def test_a_dead_or_wild_compass_is_noticed_and_gyro_and_course_do(fault: str, bit: EstimateFault) -> None:
    passage = under_way(f"what='compass', {fault}", course=square(40.0))
    passage.sail(30.0)
    assert min(passage.first_s.get(one, math.inf) for one in bit) < 3.0
    assert passage.heading_error_rad < math.radians(6.0)
    assert EstimateFault.HEADING_LOST not in passage.first_s


@pytest.mark.parametrize(
    ("fault", "bit"),
    [
        ("what='compass', kind='intermittent'", EstimateFault.COMPASS_INTERMITTENT),
        ("what='gnss', kind='intermittent', size=2.0", EstimateFault.GNSS_INTERMITTENT),
    ],
)
def test_a_sensor_that_is_silent_for_one_second_of_two_has_a_loose_contact(
    fault: str, bit: EstimateFault
) -> None:
    passage = under_way(f"{fault}, for_s=20.0", course=square(25.0))
    passage.sail(20.0)
    assert passage.first_s[bit] < 3.5
    assert set(passage.first_s) == {bit}, "and nothing else is wrong"
    assert passage.error_m < 1.0
    passage.sail(25.0)
    assert not passage.sail(5.0).faults


def test_a_compass_that_turns_away_slowly_is_found_out_by_gyro_and_course() -> None:
    passage = under_way("what='compass', kind='drift', size=-2.0, for_s=60.0", course=square(37.0))
    passage.sail(14.0)
    assert passage.first_s[EstimateFault.COMPASS_OFF] < 12.0
    assert passage.heading_error_rad < math.radians(22.0)
    passage.sail(46.0)
    assert passage.heading_error_rad < math.radians(8.0)
    assert EstimateFault.HEADING_LOST not in passage.first_s
    passage.sail(35.0)
    assert not passage.sail(5.0).faults, "and believed again once it agrees"


def test_with_neither_compass_nor_gyro_a_boat_at_rest_loses_its_heading() -> None:
    passage = under_way("what='compass', kind='off'", "environment.current_m_s=0.0", course=((30.0, 0.0),))
    passage.sail(30.0)
    assert EstimateFault.HEADING_LOST in passage.first_s


@pytest.mark.parametrize("kind", ["stuck", "wrong"])
def test_without_a_good_gyro_the_compass_does(kind: str) -> None:
    passage = under_way(f"what='gyro', kind='{kind}'", course=square(40.0))
    passage.sail(2.5)  # until it is found out
    passage.sail(35.0)
    assert passage.heading_error_rad < math.radians(14.0)
    assert EstimateFault.HEADING_LOST not in passage.first_s


def test_the_current_is_known_after_two_legs() -> None:
    rig = Rig("open", "environment.current_m_s=1.0", "environment.current_to_deg=0.0")
    rig.sail(*(waypoint(*corner) for corner in square(40.0)))
    rig.run(60.0)
    squares = []
    for _ in range(20):
        rig.run(0.5)
        nav, truth = rig.boat.nav, rig.world.truth
        assert nav is not None
        off = complex(
            nav.current_north_m_s - truth.current_north_m_s, nav.current_east_m_s - truth.current_east_m_s
        )
        squares.append(abs(off) ** 2)
    assert math.sqrt(sum(squares) / len(squares)) < 0.12
