"""Which motor has failed: from what hull and battery show of it, and not from wind."""

import copy
import math
from collections.abc import Callable
from functools import cache
from random import Random

import pytest

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon
from companion.core.intent import Drive
from companion.core.readings import BatteryReading, GnssFix
from companion.core.state import EstimateFault, NavState
from companion.failsafe.motors.evidence import MotorEvidence
from companion.failsafe.motors.hypotheses import HYPOTHESES, Fault
from companion.failsafe.motors.watch import MotorWatch
from companion.failsafe.recovery.recovery import COMPARISON_S, comparison_intent

DT_S = 0.1
HERE = LatLon(50.0, -1.2)
CONFIG = BoatConfig()
Wind = Callable[[float], float]


def still(_: float) -> float:
    return 0.0


class Hull:
    """A hull, its motors and its battery, written from the motor's equation: shafts, thrust, current.

    fault: of one side. turning_nm, pushing_n: of the wind, in rad/s² and m/s². Its figures are not those that
    the watch assumes. current: None is a boat without a monitor.
    """

    def __init__(self, seed: int = 1, *, has_current: bool = True, fix_s: float = 0.2) -> None:
        self.random = Random(seed)
        self.watch = MotorWatch(CONFIG)
        self.now_s = 0.0
        self.heading = self.rate = self.speed = 0.0
        self.shafts = [0.0, 0.0]
        self.faults: list[Fault | None] = [None, None]
        self.turning: Wind = still
        self.pushing: Wind = still
        self.has_current, self.fix_s = has_current, fix_s
        self.fix: GnssFix | None = None
        self.estimate_faults = 0
        self.has_gyro = True
        self.frozen_a: float | None = None
        self.may_compare, self.compared_s, self.is_left_first = True, -math.inf, True

    def step(self, left: float, right: float) -> None:
        """One tick of the failsafes under these commands."""
        substeps = 5
        current = 0.0
        for _ in range(substeps):
            dt, thrusts, current = DT_S / substeps, [], 0.6
            for side, duty in enumerate((left, right)):
                thrust, drawn = self._motor(side, duty, dt)
                thrusts.append(thrust)
                current += drawn
            pull = thrusts[0] - thrusts[1]
            self.rate += dt * (0.4 * pull - 0.9 * self.rate + self.turning(self.now_s))
            self.heading += dt * self.rate
            drag = (0.06 + 0.08 * abs(self.speed)) * self.speed
            self.speed += dt * (0.5 * sum(thrusts) - drag + self.pushing(self.now_s))
            self.now_s += dt
        gauss = self.random.gauss
        if self.fix is None or self.now_s - self.fix.time_s >= self.fix_s - 1e-6:
            self.fix = GnssFix(self.now_s, HERE, 3, 12, 0.9, self.speed + gauss(0.0, 0.05), gauss(0.0, 0.05))
        rate = self.rate if self.has_gyro else 0.0
        nav = NavState(
            self.now_s, 0.0, 0.0, 0.0, rate + gauss(0.0, 0.005), self.speed, 0.0, self.speed, 0.0,
            0.1, 0.1, faults=self.estimate_faults,
        )  # fmt: skip
        measured_a = current + gauss(0.0, 0.05) if self.frozen_a is None else self.frozen_a
        battery = BatteryReading(self.now_s, 12.0, measured_a if self.has_current else None)
        self.watch.update(left, right, nav, self.fix, battery, CONFIG, self.now_s, DT_S)

    def _motor(self, side: int, duty: float, dt: float) -> tuple[float, float]:
        fault = self.faults[side]
        if fault is Fault.DEAD:
            self.shafts[side] = 0.0
            return 0.0, 0.0
        sign = {Fault.REVERSED: -1.0, Fault.WEAK: 0.5}.get(fault, 1.0) if fault is not None else 1.0
        driven = sign * duty
        weed = 0.22 if fault is Fault.FOULED else 0.0
        reached = 0.0 if fault is Fault.BLOCKED else max(abs(driven) - weed, 0.0)
        self.shafts[side] += dt / 0.15 * (math.copysign(reached, driven) - self.shafts[side])
        shaft = self.shafts[side]
        drawn = max(5.5 * driven * (driven - 0.42 * shaft) - 0.15 * driven * self.speed, 0.0)
        push = abs(shaft) * (shaft - 0.1 * self.speed)
        return (push if push > 0.0 else 0.62 * push), drawn

    def sail(self, seconds: float, throttle: float = 0.6) -> None:
        """A heading loop on a course with a right angle every 15 s; steering goes before thrust."""
        for _ in range(round(seconds / DT_S)):
            course = 0.0 if self.now_s % 30.0 < 15.0 else 0.5 * math.pi
            off = math.remainder(course - self.heading, math.tau)
            steering = min(max(1.2 * off - 0.8 * self.rate, -1.0), 1.0)
            room = 1.0 - abs(steering)
            ahead = min(max(throttle + 0.5 * (1.8 - self.speed), -room), room)
            self.step(*(self.compared() or (ahead + steering, ahead - steering)))

    def compared(self) -> tuple[float, float] | None:
        """The commands of a comparison, which begins when the watch needs one, and may begin."""
        if self.may_compare and self.watch.needs_comparison and self.now_s >= self.compared_s + COMPARISON_S:
            self.compared_s, self.is_left_first = self.now_s, self.watch.compare(self.now_s)
        elapsed_s = self.now_s - self.compared_s
        if elapsed_s >= COMPARISON_S:
            return None
        drive = comparison_intent(elapsed_s, is_left_first=self.is_left_first)
        assert isinstance(drive, Drive)
        return drive.throttle + drive.steering, drive.throttle - drive.steering

    def seconds_to_verdict(self, most_s: float, throttle: float = 0.6) -> float:
        """How long it sails until there is a verdict; infinite beyond most_s."""
        began_s = self.now_s
        while self.now_s < began_s + most_s:
            self.sail(DT_S, throttle)
            if self.watch.verdict is not None:
                return self.now_s - began_s
        return math.inf


@cache
def _sailed(has_current: bool) -> Hull:
    hull = Hull(has_current=has_current)
    hull.may_compare = False
    hull.sail(40.0)
    assert hull.watch.verdict is None
    hull.may_compare = True
    return hull


def sailed(has_current: bool = True) -> Hull:
    """A hull whose watch has learned for 40 s what is usual."""
    return copy.deepcopy(_sailed(has_current))


def verdict_of(hull: Hull) -> tuple[bool, Fault] | None:
    """Side and fault; a function, so that the type checker expects it to change."""
    verdict = hull.watch.verdict
    return None if verdict is None else (verdict.is_left, verdict.fault)


SIDES = pytest.mark.parametrize("side", [0, 1], ids=["left", "right"])


@SIDES
@pytest.mark.parametrize(
    ("fault", "within_s", "text"),
    [
        (Fault.DEAD, 3.0, "{Side} motor gives no thrust"),
        (Fault.BLOCKED, 3.5, "{Side} motor is blocked"),
        (Fault.FOULED, 6.0, "Weed on the {side} propeller"),
        (Fault.REVERSED, 8.0, "Steering lost: {side} motor reversed"),
        (Fault.WEAK, 6.0, "{Side} motor is weak"),
    ],
)
def test_each_fault_is_named_with_its_side(side: int, fault: Fault, within_s: float, text: str) -> None:
    hull = sailed()
    hull.faults[side] = fault
    assert hull.seconds_to_verdict(within_s) <= within_s
    name = ("left", "right")[side]
    said = text.format(side=name, Side=name.capitalize())
    verdict = next(one for one in HYPOTHESES if (one.is_left, one.fault) == verdict_of(hull))
    assert (verdict.text, verdict.is_left, verdict.fault) == (said, side == 0, fault)
    assert verdict.has_thrust is (fault not in (Fault.DEAD, Fault.BLOCKED))


def test_a_current_that_is_measured_spares_the_trial() -> None:
    """Steered hard in a wind that is as strong: only a boat without a monitor has to try."""
    for has_current in (True, False):
        hull = Hull(has_current=has_current)
        hull.sail(20.0)
        began_s = hull.now_s
        hull.turning = lambda t, began_s=began_s: -0.6 * min((t - began_s) / 2.0, 1.0)  # type: ignore[misc]
        asked_s = math.inf
        for _ in range(200):
            hull.step(0.9, -0.9)
            if hull.watch.needs_check:
                asked_s = min(asked_s, hull.now_s - began_s)
        assert (asked_s == math.inf) is has_current, asked_s
        assert has_current or 6.0 <= asked_s <= 10.0, asked_s
        hull.watch.clear(hull.now_s)
        for _ in range(100):
            hull.step(0.9, -0.9)
        assert not hull.watch.needs_check, "the trial stands"


@pytest.mark.parametrize("has_current", [True, False])
@pytest.mark.parametrize("turning", [-0.6, 0.6])
def test_wind_that_takes_all_steering_accuses_no_motor(turning: float, has_current: bool) -> None:
    """Steered hard for half a minute, the bow does not turn: the wind does that within two seconds."""
    hull = sailed(has_current)
    began_s = hull.now_s
    hull.turning = lambda t: turning * min((t - began_s) / 2.0, 1.0)
    for _ in range(300):
        share = 0.9 * min((hull.now_s - began_s) / 2.0, 1.0) * math.copysign(1.0, -turning)
        swing = 0.1 * math.sin(3.0 * hull.now_s)
        hull.step(share + swing, -share - swing)
        assert hull.watch.verdict is None, hull.now_s - began_s


@SIDES
def test_one_motor_alone_tells_which_propeller_is_fouled(side: int) -> None:
    """On a straight course both commands are alike, and the heading loop absorbs what turns the hull."""
    named = []
    for may_compare in (True, False):
        hull = Hull()
        hull.may_compare = may_compare
        hull.sail(40.0)
        hull.heading = hull.rate = 0.0
        hull.faults[side] = Fault.FOULED
        hull.turning = lambda _, hull=hull: -2.0 * hull.heading - 2.0 * hull.rate  # type: ignore[misc]
        for _ in range(80):
            hull.step(*(hull.compared() or (0.6, 0.6)))
        named.append(verdict_of(hull))
    assert named == [(side == 0, Fault.FOULED), None]


@pytest.mark.parametrize(("late_s", "waiting"), [(0.0, 0), (0.3, 3)])
def test_a_fix_counts_for_the_time_it_was_measured(late_s: float, waiting: int) -> None:
    """What the motors have done since then is left for the next fix."""
    evidence = MotorEvidence(CONFIG)
    for tick in range(50):
        now_s = tick * DT_S
        nav = NavState(now_s, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.1, 0.1)
        fix = GnssFix(now_s - late_s, HERE, 3, 12, 0.9, 1.0, 0.0)
        evidence.update(0.6, 0.6, nav, fix, None, 1.0, DT_S)
    assert len(evidence._pending) == waiting


def test_disarming_ends_what_a_trial_has_said() -> None:
    hull = sailed()
    hull.watch.clear(hull.now_s)
    hull.watch.rearm()
    hull.sail(5.0)
    hull.faults[1] = Fault.DEAD
    assert hull.seconds_to_verdict(3.0) < 3.0


def test_a_trial_that_clears_the_motors_stands_for_three_minutes() -> None:
    hull = sailed()
    hull.faults[0] = Fault.DEAD
    hull.watch.clear(hull.now_s)
    assert hull.seconds_to_verdict(179.0) == math.inf
    hull.faults[0] = None
    hull.sail(40.0)  # what both draw is learned anew, after three minutes with one alone
    hull.faults[0] = Fault.DEAD
    assert hull.seconds_to_verdict(3.0) < 3.0


def test_a_current_monitor_that_was_silent_may_be_late_until_the_next_voyage() -> None:
    """Late readings do not fit the commands, and healthy motors were reported as fouled."""
    for silent_s, tells in ((1.5, True), (2.5, False)):
        hull = Hull()
        hull.sail(20.0)
        hull.has_current = False
        hull.sail(silent_s)
        hull.has_current = True
        hull.sail(5.0)
        assert hull.watch._evidence.has_current is tells
        hull.watch.rearm()
        hull.sail(5.0)
        assert hull.watch._evidence.has_current


@pytest.mark.parametrize("fault", [EstimateFault.COMPASS_LATE, EstimateFault.GNSS_JUMPING])
def test_what_a_sensor_told_before_it_was_found_out_is_no_evidence(fault: EstimateFault) -> None:
    evidence = MotorEvidence(CONFIG)
    for faults, expected in ((0, True), (int(fault), False), (int(fault), True)):
        evidence.against[3] = 15.0
        nav = NavState(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.1, 0.1, faults=faults)
        evidence.update(0.5, 0.5, nav, None, None, 1.0, DT_S)
        assert (evidence.against[3] > 10.0) is expected


def watched(monkeypatch: pytest.MonkeyPatch, against: dict[int, float]) -> Hull:
    """A hull whose evidence stands still: nats by the number of the hypothesis."""
    monkeypatch.setattr(MotorEvidence, "update", lambda *_: None)
    hull = Hull()
    hull.watch._evidence.has_current = True
    for at, nats in against.items():
        hull.watch._evidence.against[at] = nats
    return hull


# Of the left motor; the last two of the right
DEAD, BLOCKED, REVERSED, WEAK, RIGHT_BLOCKED, FOULED = 0, 1, 3, 4, 7, 8


@pytest.mark.parametrize(
    ("against", "is_compared", "named"),
    [
        ({REVERSED: 15.5}, False, None),
        ({REVERSED: 16.5}, False, REVERSED),
        ({FOULED: 15.0}, False, None),
        ({FOULED: 12.0}, True, None),
        ({FOULED: 14.0}, True, FOULED),  # a comparison proves with less evidence
        (
            {BLOCKED: 100.0, RIGHT_BLOCKED: 96.5},
            False,
            None,
        ),  # both commanded alike: the current hardly tells which
        ({BLOCKED: 100.0, RIGHT_BLOCKED: 95.5}, False, BLOCKED),
    ],
)
def test_a_fault_is_proved_by_its_evidence_and_its_lead(
    monkeypatch: pytest.MonkeyPatch, against: dict[int, float], is_compared: bool, named: int | None
) -> None:
    hull = watched(monkeypatch, against)
    if is_compared:
        assert not hull.watch.compare(hull.now_s), "the right motor first"
    began_s = hull.now_s
    while hull.watch.verdict is None and hull.now_s < 3.0:
        hull.step(0.5, 0.5)
    assert hull.watch.verdict is (None if named is None else HYPOTHESES[named])
    assert hull.now_s - began_s > 0.75, "without a break"
    assert named is None or hull.now_s - began_s < 1.2


@pytest.mark.parametrize(
    ("against", "named", "at_s"),
    [
        ({DEAD: 30.0, WEAK: 27.5}, DEAD, 0.9),
        ({DEAD: 27.5, WEAK: 30.0}, WEAK, 0.9),
        ({DEAD: 30.0, WEAK: 28.5}, WEAK, 5.1),  # alike: "weak" claims less
        ({DEAD: 28.5, WEAK: 30.0}, WEAK, 5.1),
        ({DEAD: 30.0, WEAK: 26.5, BLOCKED: 26.5}, None, math.inf),
    ],
)
def test_a_weak_motor_is_told_from_a_dead_one_or_called_weak(
    monkeypatch: pytest.MonkeyPatch, against: dict[int, float], named: int | None, at_s: float
) -> None:
    hull = watched(monkeypatch, against)
    while hull.watch.verdict is None and hull.now_s < 8.0:
        hull.step(0.5, 0.5)
    assert hull.watch.verdict is (None if named is None else HYPOTHESES[named])
    assert named is None or hull.now_s == pytest.approx(at_s, abs=0.15)


def test_dead_or_weak_by_turns_is_proved_as_soon_as_they_part(monkeypatch: pytest.MonkeyPatch) -> None:
    hull = watched(monkeypatch, {DEAD: 30.0, WEAK: 29.0})
    for tick in range(20):
        hull.watch._evidence.against[WEAK] = 29.0 + 2.0 * (tick % 2)
        hull.step(0.5, 0.5)
        assert hull.watch.verdict is None
    hull.watch._evidence.against[WEAK] = 40.0
    hull.step(0.5, 0.5)
    assert hull.watch.verdict is HYPOTHESES[WEAK]


LEFT_FOULED = 2


def compared(monkeypatch: pytest.MonkeyPatch, left: float, right: float) -> Hull:
    """A hull whose comparison has just ended, with these nats for weed on either side, which stand still."""
    monkeypatch.setattr(MotorEvidence, "knows_current", property(lambda _: True))
    hull = watched(monkeypatch, {LEFT_FOULED: left, FOULED: right})
    hull.watch._evidence._current._learned_s = 99.0
    hull.step(0.5, 0.5)
    assert hull.watch.needs_comparison
    hull.watch.compare(hull.now_s)
    for _ in range(41):
        hull.step(0.5, 0.5)
    return hull


def test_a_comparison_that_finds_both_motors_alike_clears_them_for_three_minutes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hull = compared(monkeypatch, 10.5, 9.0)
    against = hull.watch._evidence.against
    assert max(against) == 0.0
    assert hull.watch._evidence._current._learned_s == 0.0, "what both draw is learned as usual"
    against[LEFT_FOULED] = 10.5
    while hull.now_s < 183.9:
        hull.step(0.5, 0.5)
        assert not hull.watch.needs_comparison
    while hull.now_s < 184.4:
        hull.step(0.5, 0.5)
    assert hull.watch.needs_comparison


def test_the_next_voyage_begins_without_the_result_of_a_comparison(monkeypatch: pytest.MonkeyPatch) -> None:
    hull = compared(monkeypatch, 10.5, 9.0)
    hull.watch.rearm()
    hull.watch._evidence.against[LEFT_FOULED] = 10.5
    hull.step(0.5, 0.5)
    assert hull.watch.needs_comparison


def test_where_one_motor_draws_more_they_are_compared_again(monkeypatch: pytest.MonkeyPatch) -> None:
    assert compared(monkeypatch, 12.5, 8.0).watch.needs_comparison
