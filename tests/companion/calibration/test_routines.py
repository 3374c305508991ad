"""The calibrations afloat by the runner, on a boat that follows the model exactly; and what stops them."""

import math
from dataclasses import dataclass, field

import msgspec
import pytest
from boat_rig import FRAME, ORIGIN, nav_at
from twins.lines import known

from companion.calibration import motor_test
from companion.calibration.runner import (
    HEADING,
    STOP,
    THRUSTERS,
    Calibration,
    CalibrationResult,
    CalibrationRunner,
)
from companion.config.actuators import DriveSetting
from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import Point
from companion.core.intent import Drive, FollowLeg, HoldHeading, Intent, KeepStation, Stop
from companion.core.modes import Mode
from companion.core.readings import GnssFix
from companion.core.state import MotorCommand, NavState, Thrust
from companion.core.units import clamp, wrap_pi
from companion.core.vehicle_status import VehicleStatus
from companion.geofence.fence import Fence, FenceCircle

DT_S = 0.02
STATION = KeepStation(Point(0.0, 0.0))
LOITERING = VehicleStatus(Mode.LOITER, armed=True)
RIGHT, LEFT_DEAD, RIGHT_DEAD, ASTERN_DEAD, ASTERN = 0.9, 0.05, 0.06, 0.08, 0.64
TOP_M_S, SURGE_S, YAW_S, TURN_RAD_S = 2.4, 1.5, 0.8, 1.2
CURRENT = (0.2, -0.1)


def force(command: float, dead: float, full: float = 0.5) -> float:
    """Thrust by the curve of `pulses.py`: the command above the dead band is s + 0.4 s², 1.4 at `full`."""
    above = max(abs(command) - dead, 0.0) / (full - dead) * 1.4
    root = (math.sqrt(1.0 + 1.6 * above) - 1.0) / 0.8
    return math.copysign(root * root, command)


@dataclass
class Boat:
    """Surge and yaw of first order in a current; a weak right motor; receiver and compass without fault."""

    config: BoatConfig = field(default_factory=lambda: with_value(BoatConfig(), "speed.cruise_m_s", 1.2))
    fence: Fence = field(default_factory=Fence)
    status: VehicleStatus = LOITERING
    intent: Intent = STATION
    is_slowed: bool = False
    is_stuck: bool = False  # nothing moves it
    faults: int = 0

    def __post_init__(self) -> None:
        self.runner = CalibrationRunner()
        self.now_s = self.north = self.east = self.heading = self.rate = self.surge = 0.0
        self.command = MotorCommand(0.0, 0.0)
        self.seen: list[Intent] = []

    def start(self, kind: Calibration, radius_m: float = 0.0) -> str:
        return self.runner.start(kind, radius_m, self.status, self.nav, self.fence, self.config, self.now_s)

    @property
    def nav(self) -> NavState:
        c, s = math.cos(self.heading), math.sin(self.heading)
        north, east = c * self.surge + CURRENT[0], s * self.surge + CURRENT[1]
        return msgspec.structs.replace(
            nav_at(self.north, self.east, self.now_s), heading_rad=self.heading, yaw_rate_rad_s=self.rate,
            north_m_s=north, east_m_s=east, surge_m_s=c * north + s * east, current_north_m_s=CURRENT[0],
            current_east_m_s=CURRENT[1], faults=self.faults,
        )  # fmt: skip

    def tick(self) -> None:
        self.now_s += DT_S
        nav = self.nav
        delayed = GnssFix(round(self.now_s // 0.2 * 0.2, 6), ORIGIN, 3, 12, 0.8, nav.north_m_s, nav.east_m_s)
        intent = self.runner.update(
            self.intent, self.status, nav, self.fence, self.config, self.now_s, fix=delayed,
            command=self.command, is_slowed=self.is_slowed,
        )  # fmt: skip
        self.seen.append(intent)
        if not self.is_stuck:
            self.move(intent)

    def move(self, intent: Intent) -> None:
        match intent:
            case Drive(throttle, steering):
                left, right = throttle + steering, throttle - steering
                if abs(throttle) > 0.0:
                    left, right = clamp(left, -1.0, 1.0), clamp(right, -1.0, 1.0)
            case HoldHeading(heading, speed):
                left, right = self.steer(heading, speed)
            case FollowLeg(_, end, speed):
                left, right = self.steer_to(end, speed)
            case KeepStation(end):
                left, right = self.steer_to(end, 1.0)
            case Stop():
                left = right = 0.0
            case _:
                raise AssertionError(intent)
        self.command = MotorCommand(left, right)
        forces = (
            force(left, LEFT_DEAD) if left > 0.0 else ASTERN * force(left, ASTERN_DEAD),
            force(right * RIGHT, RIGHT_DEAD * RIGHT) if right > 0.0 else ASTERN * force(right, ASTERN_DEAD),
        )
        shares = [math.copysign(math.sqrt(abs(one) / force(1.0, LEFT_DEAD)), one) for one in forces]
        self.surge += DT_S / SURGE_S * (TOP_M_S * 0.5 * sum(shares) - self.surge)
        self.rate += DT_S / YAW_S * (TURN_RAD_S * 0.5 * (forces[0] - forces[1]) - self.rate)
        self.heading = wrap_pi(self.heading + DT_S * self.rate)
        self.north += DT_S * (math.cos(self.heading) * self.surge + CURRENT[0])
        self.east += DT_S * (math.sin(self.heading) * self.surge + CURRENT[1])

    def steer_to(self, end: Point, speed_m_s: float) -> tuple[float, float]:
        north, east = end.north_m - self.north, end.east_m - self.east
        return self.steer(math.atan2(east, north), min(speed_m_s, 0.5 * math.hypot(north, east)))

    def steer(self, heading_rad: float, speed_m_s: float) -> tuple[float, float]:
        """Commands as the boat's controllers end up with: known motors, so that the boat goes straight."""
        error = wrap_pi(heading_rad - self.heading)
        yaw = clamp(0.8 * error - 0.8 * self.rate, -0.4, 0.4)
        speed = clamp(speed_m_s / TOP_M_S, 0.0, 1.0) if abs(error) < 0.5 else 0.0
        shares = (speed + yaw, speed - yaw)
        root = math.sqrt(force(1.0, LEFT_DEAD))
        wanted = [clamp(share, -1.0, 1.0) * root for share in shares]
        left, right = (math.copysign((abs(w) + 0.4 * w * w) / 1.4, w) for w in wanted)
        left += math.copysign(LEFT_DEAD, left) - LEFT_DEAD * left / 0.5 if left else 0.0
        right += math.copysign(RIGHT_DEAD * RIGHT, right) - RIGHT_DEAD * RIGHT * right / 0.5 if right else 0.0
        return 0.5 * left, 0.5 * right / RIGHT

    def run(self, seconds: float = 1500.0) -> CalibrationResult:
        until_s = self.now_s + seconds
        while self.runner.is_running and self.now_s < until_s:
            self.tick()
        result = known(self.runner.take_result())
        assert self.runner.take_result() is None
        assert not self.runner.is_bare
        return result


def found(boat: Boat, kind: Calibration) -> dict[str, float]:
    assert boat.start(kind) == ""
    assert boat.runner.is_bare is (kind is THRUSTERS)
    result = boat.run()
    assert (result.kind, result.reason) == (kind, "")
    assert math.hypot(boat.north, boat.east) < 3.0, "back at its station"
    return {one.name: one.value for one in result.findings}


def test_the_thruster_calibration_finds_the_motors() -> None:
    values = found(Boat(), THRUSTERS)
    # Truth: dead bands of 5, 8, 6 and 8 %, a left gain of 0.9. Exactly, of this boat and this arithmetic
    exact = {
        "MOT_L_MIN_FWD": 4.99048, "MOT_L_MIN_REV": 7.80460, "MOT_R_MIN_FWD": 6.02602,
        "MOT_R_MIN_REV": 8.06293,
        "MOT_THST_ASYM": 1.17320, "MOT_L_GAIN": 0.898760, "MOT_R_GAIN": 1.0, "HND_TOP_SPEED": 2.35092,
        "CRUISE_THROTTLE": 43.5755, "EST_SURGE_TIME": 1.83780, "HND_TURN_RATE": 142.542,
    }  # fmt: skip
    assert values == pytest.approx(exact, rel=1e-5)


def test_the_autotune_finds_the_gains() -> None:
    values = found(Boat(), HEADING)
    assert values == pytest.approx({"HDG_KP": 6.72640, "HDG_KI": 1.34528, "HDG_KD": 1.82747}, rel=1e-5)


def test_the_stop_calibration_finds_the_way_from_cruise_and_a_bound_of_it() -> None:
    """From 1.2 m/s with thrust for 1.8 m/s astern: T (u − s ln(1 + u / s)) = 0.42 m, from half of it 0.12 m,
    which the model takes for 0.53 m from cruise. The rest is two deviations.
    """
    values = found(Boat(), STOP)
    assert values == pytest.approx({"HND_STOP": 0.700300}, rel=1e-5)


def test_a_fence_shortens_the_runs() -> None:
    boat = fenced(Boat(), 40.0)
    assert boat.start(THRUSTERS) == ""
    assert boat.runner.radius_m == pytest.approx(38.0, abs=0.1)
    most_m = 0.0
    while boat.runner.is_running:
        boat.tick()
        most_m = max(most_m, math.hypot(boat.north, boat.east))
    assert 25.0 < most_m < 0.9 * 38.0
    result = known(boat.runner.take_result())
    assert result.reason == ""


def fenced(boat: Boat, radius_m: float) -> Boat:
    boat.fence.set_areas((FenceCircle(ORIGIN, radius_m, True),))
    boat.fence.update(FRAME, None, boat.config.fence)
    return boat


def refusal(
    kind: Calibration = THRUSTERS, radius_m: float = 0.0, fence_m: float = 0.0, **changes: object
) -> str:
    boat = Boat(**changes)  # type: ignore[arg-type]
    return (fenced(boat, fence_m) if fence_m else boat).start(kind, radius_m)


def test_what_keeps_a_calibration_from_starting() -> None:
    both = with_value(BoatConfig(), "drive.layout", "differential_rudder")
    assert refusal(config=both) == "measures two motors; set a rudder boat's by hand"
    assert refusal(HEADING, config=both) == "steers with motors or a rudder, not both"
    assert refusal(status=VehicleStatus(Mode.LOITER)) == "arm first"
    assert refusal(status=VehicleStatus(Mode.MANUAL, armed=True)) == "choose LOITER first"
    assert (
        refusal(status=msgspec.structs.replace(LOITERING, failsafes=1)) == "something is wrong with the boat"
    )
    assert refusal(faults=1) == "something is wrong with the boat"
    assert refusal(radius_m=39.0, fence_m=40.0) == "the fence leaves 38.0 m"
    assert refusal(fence_m=25.9) == "needs 24.0 m of free water all round"
    assert refusal(fence_m=26.1) == refusal(radius_m=24.0) == refusal(HEADING) == ""
    assert refusal(radius_m=23.9) == "needs 24.0 m of free water all round"
    boat = Boat()
    assert (
        boat.runner.start(THRUSTERS, 0.0, LOITERING, None, boat.fence, boat.config, 0.0)
        == "choose LOITER first"
    )
    assert boat.start(THRUSTERS) == ""
    assert boat.runner.radius_m == 60.0
    assert boat.start(HEADING) == "Thruster calibration is under way"
    boat.runner.stop("asked to")
    assert boat.runner.take_result() == CalibrationResult(THRUSTERS, [], "asked to")


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"status": VehicleStatus(Mode.LOITER)}, "disarmed"),
        ({"status": msgspec.structs.replace(LOITERING, failsafes=4)}, "failsafe"),
        ({"status": msgspec.structs.replace(LOITERING, mode=Mode.HOLD)}, "mode HOLD"),
        ({"intent": Stop()}, "the boat was asked for something else"),
        ({"intent": KeepStation(Point(1.0, 0.0))}, "the boat was asked for something else"),
        ({"faults": 1}, "position or heading are in doubt"),
        ({"north": -61.5}, "the boat is 61.5 m from its station"),
        ({"now_s": 1801.0}, "it takes too long"),
    ],
)
def test_what_stops_a_calibration(changes: dict[str, object], reason: str) -> None:
    boat = Boat()
    boat.tick()
    assert boat.seen == [STATION], "it leaves the vehicle's intent alone before"
    assert boat.start(THRUSTERS) == ""
    for _ in range(100):
        boat.tick()
    assert boat.seen[-1] != STATION
    assert boat.runner.progress_percent(boat.now_s + 238.0) == 50
    assert boat.runner.progress_percent(1e4) == 99
    for name, value in changes.items():
        setattr(boat, name, value)
    boat.tick()
    assert boat.seen[-1] == boat.intent
    result = boat.run()
    assert (result.findings, result.reason) == ([], reason)
    boat.runner.stop("twice")
    assert boat.runner.take_result() is None


@pytest.mark.parametrize(
    ("kind", "changes", "reason"),
    [
        (THRUSTERS, {"is_slowed": True}, "something is in the way of every run"),
        (THRUSTERS, {"is_stuck": True}, "the boat does not reach the start of a run"),
        (HEADING, {"is_stuck": True}, "the boat does not reach the start of a run"),
        (STOP, {"is_stuck": True}, "the boat does not reach the start of a run"),
        (HEADING, {"is_slowed": True}, "too little room to swing"),
        (
            HEADING,
            {"config": with_value(BoatConfig(), "speed.cruise_throttle", 0.95)},
            "cruise speed leaves no thrust to steer with",
        ),
    ],
)
def test_a_boat_that_does_not_follow_says_what_it_does_not_do(
    kind: Calibration, changes: dict[str, object], reason: str
) -> None:
    boat = Boat(**changes)  # type: ignore[arg-type]
    assert boat.start(kind) == ""
    assert boat.run().reason == reason


# One motor on the bench


MOTORS = motor_test.TestedMotor
DISARMED = VehicleStatus(Mode.HOLD)


@pytest.mark.parametrize(
    ("motor", "layout", "share", "thrust"),
    [
        (MOTORS.THROTTLE, "differential", 0.5, Thrust(0.5, 0.5)),
        (MOTORS.STEERING, "differential", 0.5, Thrust(0.5, -0.5)),
        (MOTORS.LEFT, "differential", -2.0, Thrust(-1.0, 0.0)),
        (MOTORS.RIGHT, "differential", 0.25, Thrust(0.0, 0.25)),
        (MOTORS.STEERING, "rudder", 0.5, Thrust(0.0, 0.0, 0.5)),
        (MOTORS.THROTTLE, "rudder", 0.5, Thrust(0.5, 0.5)),
    ],
)
def test_a_tested_motor_turns_for_its_time(motor: int, layout: str, share: float, thrust: Thrust) -> None:
    test, drive = motor_test.MotorTest(), DriveSetting(layout=layout)  # type: ignore[arg-type]
    assert test.decided_s == -math.inf
    assert test.thrust(DISARMED, 9.9) == Thrust(0.0, 0.0)
    assert test.start(MOTORS(motor), share, 2.0, DISARMED, 10.0, drive) == ""
    assert (test.thrust(DISARMED, 11.9), test.is_running) == (thrust, True)
    assert (test.thrust(DISARMED, 12.0), test.is_running) == (Thrust(0.0, 0.0), False)
    assert test.decided_s == 12.0


def test_a_motor_test_is_refused_and_ended_by_what_the_boat_does() -> None:
    test = motor_test.MotorTest()
    assert [one.value for one in MOTORS] == [1, 2, 3, 4], "as in Rover"
    assert test.start(MOTORS.LEFT, 0.5, 2.0, LOITERING, 0.0) == "disarm first"
    assert (
        test.start(MOTORS.LEFT, 0.5, 2.0, msgspec.structs.replace(DISARMED, is_restarting=True), 0.0)
        == "the program is restarting"
    )
    one = DriveSetting(layout="rudder")
    assert (
        test.start(MOTORS.RIGHT, 0.5, 2.0, DISARMED, 0.0, one)
        == "this boat has one motor: test throttle or steering"
    )
    for changed in (
        msgspec.structs.replace(DISARMED, armed=True),
        msgspec.structs.replace(DISARMED, failsafes=2),
        msgspec.structs.replace(DISARMED, mode=Mode.LOITER),
    ):
        assert test.start(MOTORS.LEFT, 0.5, 99.0, DISARMED, 0.0) == ""
        assert test.thrust(DISARMED, 29.9) == Thrust(0.5, 0.0)
        assert test.thrust(changed, 29.9) == test.thrust(DISARMED, 29.9) == Thrust(0.0, 0.0)
    assert test.start(MOTORS.LEFT, 0.5, 99.0, DISARMED, 0.0) == ""
    assert test.thrust(DISARMED, 30.0) == Thrust(0.0, 0.0), "30 s at most, as in Rover"
