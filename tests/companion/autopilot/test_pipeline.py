"""The pipeline from intent to motor command: when guidance runs, what it passes on, what stops the motors."""

import math

import pytest
from laid_fence import laid, square
from msgspec.structs import replace

from companion.autopilot.pipeline import GUIDANCE_S, GuidancePipeline
from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import HoldCourse, Intent
from companion.core.modes import Mode
from companion.core.state import Demand, MotorCommand, MotorState, MotorStates, NavState
from companion.core.status_text import StatusText
from companion.core.vehicle_status import VehicleStatus
from companion.geofence.fence import Fence
from companion.guidance.stall_detector import StallVerdict
from companion.obstacles.perception.voyage_map import VoyageMap

CONFIG = BoatConfig()
ARMED = VehicleStatus(Mode.GUIDED, armed=True)
NORTH = HoldCourse(0.0, 1.0)
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1)


class Line:
    """A pipeline with its surroundings held."""

    def __init__(self, fence: Fence | None = None, status: VehicleStatus = ARMED) -> None:
        self.texts: list[StatusText] = []
        self.pipeline = GuidancePipeline(CONFIG, self.texts, VoyageMap())
        self.fence, self.status = fence or Fence(), status

    def guide(self, intent: Intent, now_s: float, nav: NavState | None = STILL) -> Demand | None:
        nav = None if nav is None else replace(nav, time_s=now_s)
        self.pipeline.guide(intent, nav, self.status, self.fence, CONFIG, now_s)
        return self.pipeline.demand

    def drive(self, now_s: float, nav: NavState | None = STILL, ticks: int = 50) -> MotorCommand:
        nav = None if nav is None else replace(nav, time_s=now_s)
        for _ in range(ticks):
            command = self.pipeline.drive(nav, self.status, CONFIG, now_s, 0.02)
        return command

    def held_s(self, course_rad: float, nav: NavState = STILL) -> float:
        """Seconds of full thrust after which a boat that does not move is found to be held."""
        for tenth in range(130):
            now_s = 5.0 + 0.1 * tenth
            self.guide(HoldCourse(course_rad, 3.0), now_s, nav)
            self.drive(now_s, nav, ticks=5)
            if self.pipeline.headway.verdict is not StallVerdict.MAKING_WAY:
                break
        return now_s - 5.0


def test_guidance_is_due_every_tenth_of_a_second_or_at_a_request() -> None:
    line = Line()
    assert line.pipeline.is_due(0.0)
    line.guide(NORTH, 5.0)
    assert not line.pipeline.is_due(5.0 + 0.9 * GUIDANCE_S)
    assert line.pipeline.is_due(5.0 + GUIDANCE_S)
    line.pipeline.request_update()
    assert line.pipeline.is_due(5.0)
    line.guide(NORTH, 6.0)
    line.pipeline.idle()
    assert line.pipeline.is_due(6.0)
    assert line.pipeline.demand is None


def test_a_course_is_held_and_drives_both_motors() -> None:
    line = Line()
    demand = line.guide(NORTH, 5.0)
    assert demand is not None
    assert (demand.heading_rad, demand.speed_m_s) == (0.0, 1.0)
    command = line.drive(5.0)
    assert command.left == command.right > 0.2


def test_a_closed_loop_needs_an_estimate_and_a_fresh_one() -> None:
    line = Line()
    line.guide(NORTH, 5.0)
    assert line.drive(5.0).reason == ""
    assert line.drive(5.0, None).reason == "no estimate"
    old = replace(STILL, time_s=4.0)
    assert line.pipeline.drive(old, ARMED, CONFIG, 5.0, 0.02).reason == "estimate is stale"
    lost = replace(STILL, time_s=5.0, position_age_s=4.0)
    assert line.pipeline.drive(lost, ARMED, CONFIG, 5.0, 0.02).reason == "position is stale"
    heading_only = replace(ARMED, needs_position=False)
    assert line.pipeline.drive(lost, heading_only, CONFIG, 5.0, 0.02).reason == ""


def test_guidance_that_is_silent_or_a_boat_that_is_disarmed_stops_the_motors() -> None:
    line = Line()
    line.guide(NORTH, 5.0)
    assert line.drive(5.4).reason == ""
    assert line.drive(5.6).reason == "command is stale"
    line.guide(NORTH, 5.6)
    line.status = VehicleStatus(Mode.GUIDED)
    assert line.drive(5.6).reason == "disarmed"
    assert line.pipeline.helm.speed_pid is None, "the loops forget"


def test_before_the_fence_the_boat_slows_unless_motors_are_checked_or_it_gets_off_the_shore() -> None:
    fast = HoldCourse(0.0, 2.0)
    near = replace(STILL, north_m=16.0, north_m_s=2.0, surge_m_s=2.0)
    for status, brakes in (
        (ARMED, True),
        (replace(ARMED, is_checking_motors=True), False),
        (replace(ARMED, is_ungrounding=True), False),
    ):
        demand = Line(laid(square(20.0)), status).guide(fast, 5.0, near)
        assert demand is not None
        assert (demand.speed_m_s < 1.9) is brakes


def test_with_one_motor_the_boat_drifts_where_it_cannot_hold_its_own() -> None:
    status = replace(ARMED, motors=MotorStates(left=MotorState.FAILED))
    demand = Line(status=status).guide(NORTH, 5.0)
    assert demand is not None
    assert demand.speed_m_s == 1.0
    # 0.12 of the top speed of 3 m/s is less than this current: bow into it
    fast_water = replace(STILL, current_east_m_s=0.4)
    drift = Line(status=status).guide(NORTH, 5.0, fast_water)
    assert drift is not None
    assert drift.heading_rad == pytest.approx(-math.pi / 2.0)
    assert drift.speed_m_s == pytest.approx(0.36 - 0.4)
    slow_water = Line(status=status).guide(NORTH, 5.0, replace(STILL, current_east_m_s=0.3))
    assert slow_water is not None
    assert slow_water.heading_rad != pytest.approx(-math.pi / 2.0)
    healthy = Line().guide(NORTH, 5.0, fast_water)
    assert healthy is not None
    assert healthy.heading_rad != pytest.approx(-math.pi / 2.0)


def test_a_boat_that_is_held_is_found_stuck_after_ten_seconds_of_full_thrust() -> None:
    line = Line()
    assert 9.5 < line.held_s(0.0) < 12.0
    assert line.pipeline.headway.verdict is StallVerdict.STUCK


@pytest.mark.parametrize(("gap_m", "verdict"), [(1.1, StallVerdict.AGROUND), (1.3, StallVerdict.STUCK)])
def test_a_boat_that_is_held_within_reach_of_the_line_is_aground(gap_m: float, verdict: StallVerdict) -> None:
    line, east = Line(laid(square(20.0))), 0.5 * math.pi
    held_s = line.held_s(east, replace(STILL, north_m=20.0 - gap_m, heading_rad=east))
    assert line.pipeline.headway.verdict is verdict
    assert (held_s < 8.0) is (verdict is StallVerdict.AGROUND)


@pytest.mark.parametrize(("gap_m", "verdict"), [(0.7, StallVerdict.AGROUND), (0.9, StallVerdict.STUCK)])
def test_a_boat_that_is_held_where_it_saw_a_shore_is_aground(gap_m: float, verdict: StallVerdict) -> None:
    line, east = Line(), 0.5 * math.pi
    line.pipeline.perception.voyage._add((0, 0), Point(gap_m, 0.0))
    line.held_s(east, replace(STILL, heading_rad=east))
    assert line.pipeline.may_touch is (verdict is StallVerdict.AGROUND)
    assert line.pipeline.headway.verdict is verdict


def test_the_heading_that_waves_add_is_not_steered_against() -> None:
    calm, wavy = Line(), Line()
    for line, nav in (
        (calm, STILL),
        (wavy, replace(STILL, heading_rad=0.1, yaw_rate_rad_s=0.2, wave_rad=0.1, wave_rad_s=0.2)),
    ):
        line.guide(NORTH, 1.0, nav)
        line.drive(1.0, nav)
    assert wavy.pipeline.demand == calm.pipeline.demand
    assert wavy.pipeline.helm.heading_pid == calm.pipeline.helm.heading_pid
