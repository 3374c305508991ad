"""Which motor has failed, from what speed controllers report alone."""

import math
from random import Random

import pytest

from companion.config.actuators import MotorsPart
from companion.config.boat_config import BoatConfig, Parts
from companion.core.readings import EscReading
from companion.core.state import EstimateFault, NavState
from companion.failsafe.motors.hypotheses import Fault
from companion.failsafe.motors.shaft import Shaft
from companion.failsafe.motors.watch import MotorWatch

DT_S = 0.1
CONFIG = BoatConfig(parts=Parts(motors=MotorsPart(driver="esc", telemetry="kiss")))
# No motion tells anything: what remains are the reports
BLIND = int(EstimateFault.COMPASS_LOST | EstimateFault.GNSS_LOST)


class Motor:
    """A brushless motor of 900 turns a minute per volt on 4 cells, and its propeller, at steady state: the
    motor's equation and Q = q n² − p n u solved for n. Other figures than those of any emulated boat.
    """

    def __init__(self) -> None:
        self.fault: Fault | None = None
        self.speed_rad_s = self.current_a = 0.0

    def step(self, duty: float, volt: float, water_m_s: float) -> None:
        k, ohm, friction_nm = 60.0 / math.tau / 900.0, 0.11, 0.004
        q, p = 4.0e-7, 3.0e-5
        if self.fault is Fault.WEAK:
            duty *= 0.5
        if self.fault is Fault.FOULED:
            q *= 1.5
        if self.fault is Fault.LOST:
            q = p = 0.0
        if self.fault is Fault.DEAD or duty <= 0.0:
            self.speed_rad_s = self.current_a = 0.0
            return
        if self.fault is Fault.BLOCKED:
            self.speed_rad_s, self.current_a = 0.0, min(duty * duty * volt / ohm, 25.0)
            return
        b, c = k * k / ohm - p * water_m_s, friction_nm - k * duty * volt / ohm
        self.speed_rad_s = -c / b if not q else (-b + math.sqrt(b * b - 4.0 * q * c)) / (2.0 * q)
        self.current_a = duty * (duty * volt - k * self.speed_rad_s) / ohm


class Pair:
    """Two of them under changing commands. reports: which sides do."""

    def __init__(self, reports: tuple[bool, bool] = (True, True), seed: int = 1) -> None:
        self.motors = Motor(), Motor()
        self.watch = MotorWatch(CONFIG)
        self.now_s = 0.0
        self.reports = list(reports)
        self.is_frozen = False
        self._random = Random(seed)
        self._escs: list[EscReading | None] = [None, None]

    def step(self, left: float, right: float) -> None:
        self.now_s += DT_S
        water_m_s, gauss = 1.5 * 0.5 * (left + right), self._random.gauss
        for side, (motor, duty) in enumerate(zip(self.motors, (left, right), strict=True)):
            volt = 16.0 - 0.05 * motor.current_a - 0.002 * self.now_s
            motor.step(duty, volt, water_m_s)
            if self.reports[side] and not self.is_frozen:
                self._escs[side] = EscReading(
                    self.now_s, side, 1, motor.speed_rad_s, volt + gauss(0.0, 0.03),
                    max(motor.current_a + gauss(0.0, 0.15), 0.0), 30.0, 0.0,
                )  # fmt: skip
        nav = NavState(self.now_s, 0.0, 0.0, 0.0, 0.0, water_m_s, 0.0, water_m_s, 0.0, 0.1, 0.1, faults=BLIND)
        left_esc, right_esc = self._escs
        self.watch.update(left, right, nav, None, None, CONFIG, self.now_s, DT_S, escs=(left_esc, right_esc))

    def sail(self, seconds: float) -> None:
        """Cruise, with a step of speed or a turn every few seconds."""
        for _ in range(round(seconds / DT_S)):
            phase = int(self.now_s / 4.0) % 4
            ahead, turn = (0.6, 0.75, 0.5, 0.6)[phase], (0.0, 0.0, 0.0, 0.15)[phase]
            self.step(ahead + turn, ahead - turn)

    def seconds_to_verdict(self, limit_s: float = 10.0) -> float:
        began_s = self.now_s
        while self.watch.verdict is None and self.now_s - began_s < limit_s:
            self.sail(DT_S)
        return self.now_s - began_s if self.watch.verdict is not None else math.inf


@pytest.fixture
def pair() -> Pair:
    pair = Pair()
    pair.sail(60.0)
    return pair


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("fault", [Fault.DEAD, Fault.BLOCKED, Fault.FOULED, Fault.WEAK, Fault.LOST])
def test_a_fault_is_named_with_its_side(pair: Pair, fault: Fault, side: int) -> None:
    pair.motors[side].fault = fault
    assert pair.seconds_to_verdict() < 8.0
    verdict = pair.watch.verdict
    assert verdict is not None
    assert (verdict.fault, verdict.is_left) == (fault, side == 0)


@pytest.mark.parametrize("seed", range(3))
def test_healthy_motors_are_not_accused_in_ten_minutes(seed: int) -> None:
    pair = Pair(seed=seed)
    for _ in range(600):
        pair.sail(1.0)
        assert max(pair.watch._evidence.against) < 8.0
        assert pair.watch.verdict is None


def test_a_verdict_ends_when_the_propeller_is_clear_again(pair: Pair) -> None:
    pair.motors[0].fault = Fault.FOULED
    assert pair.seconds_to_verdict() < 8.0
    pair.motors[0].fault = None
    pair.sail(10.0)
    assert pair.watch.verdict is None


def test_before_the_usual_is_learned_nothing_is_said() -> None:
    pair = Pair()
    pair.motors[0].fault = Fault.WEAK  # from the start: it is taken for a smaller motor
    pair.sail(60.0)
    assert pair.watch.verdict is None


def test_a_side_that_does_not_report_is_not_judged_by_the_other() -> None:
    pair = Pair(reports=(True, False))
    pair.sail(60.0)
    pair.motors[1].fault = Fault.LOST
    assert pair.seconds_to_verdict() == math.inf
    pair.motors[1].fault, pair.motors[0].fault = None, Fault.LOST
    assert pair.seconds_to_verdict() < 8.0


def test_a_report_that_repeats_is_no_evidence(pair: Pair) -> None:
    pair.motors[0].fault = Fault.DEAD
    pair.step(0.6, 0.6)
    pair.is_frozen = True
    assert pair.seconds_to_verdict() == math.inf
    assert not pair.watch._evidence.shafts.knows(is_left=True)


def test_without_reports_a_lost_propeller_is_not_told_from_a_dead_motor(pair: Pair) -> None:
    pair.reports = [False, False]
    pair.sail(3.0)
    for at, one in enumerate(pair.watch._evidence.against):
        assert one == pytest.approx(0.0, abs=1.0), at
    pair.watch._evidence.against[5] = 30.0  # LOST, left
    pair.sail(2.0)
    assert pair.watch.verdict is None


def test_in_a_turn_and_after_a_change_of_speed_less_is_usual() -> None:
    def variances(duties: list[float], turn_rad_s: float) -> tuple[float, float]:
        shaft = Shaft()
        for tick in range(100):
            reading = EscReading(0.1 * tick, 0, 1, 300.0, 12.0, 2.0, 30.0, 0.0)
            if shaft.compare(reading, 0.5, 1.0, 0.0):
                shaft.learn(0.1)
        for tick, duty in enumerate(duties):
            reading = EscReading(20.0 + 0.1 * tick, 0, 1, 300.0, 12.0, 2.0, 30.0, 0.0)
            shaft.compare(reading, duty, 1.0, turn_rad_s)
        return shaft.speed.variance, shaft.load.variance

    steady = variances([0.5] * 6, 0.0)
    for other in (variances([0.5] * 6, 0.5), variances([0.5] * 5 + [0.6], 0.0)):
        assert all(now > 2.0 * before for now, before in zip(other, steady, strict=True))


@pytest.mark.parametrize(
    ("duties", "says"),
    [
        ([0.5] * 6, True),
        ([0.5] * 5, False),  # just begun
        ([0.5, 0.5, 0.5, 0.5, 0.5, 0.66], False),  # faster
        ([0.14] * 6, False),  # in the dead band
        ([-0.5] * 6, False),
    ],
)
def test_a_shaft_says_something_at_steady_speed_ahead(duties: list[float], says: bool) -> None:
    shaft, elapsed_s = Shaft(), 0.0
    for tick, duty in enumerate(duties):
        reading = EscReading(0.1 * tick, 0, 1, 300.0, 12.0, 2.0, 30.0, 0.0)
        elapsed_s = shaft.compare(reading, duty, 1.0, 0.0)
    assert elapsed_s == pytest.approx(0.1 * says)
