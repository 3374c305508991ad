"""Speed and load of motors whose controllers report, against those of healthy ones.

With d the duty, u the speed through the water, n the measured speed of the shaft and V the voltage at the
controller, a brushless motor ahead follows, as the motor's equation and the propeller's say
(`motor_hypotheses`; Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2021, chapter 9)

    n / V = a d + b d² + c u + e              speed per volt
    I = d (α n² − β n u + γ) + δ              current from the pack: the torque, at the share d of the time

The first says whether the shaft turns as it is driven, the second whether the propeller takes what it takes
at this speed. Both are linear in four figures, which are learned under way.
"""

import math
from collections import deque
from typing import Final

from companion.core.evidence import MOST_SQUARE
from companion.core.readings import EscPair, EscReading
from companion.core.state import NavState
from companion.failsafe.motors.current import HealthyModel
from companion.failsafe.motors.hypotheses import HYPOTHESES, EffectSize

# Tuned on sample seed 907 of examples/campaigns/motors_telemetry.toml
_SPEED_SIGMA: Final = (300.0, 300.0, 50.0, 20.0)  # rad/s per V: motors of up to 3000 turns a minute per volt
_LOAD_SIGMA: Final = (30.0, 30.0, 10.0, 1.0)  # A, with n in hundreds of rad/s
_WALK_S: Final = (1e-4, 1e-4, 1e-5, 1e-5)  # as that of the current
_DRIVEN: Final = 0.15  # of command ahead: below it lie the dead bands of controllers
# Of command, in as many reports as follow: in a change of speed the shaft lags, and takes more or less torque
_STEADY: Final = 0.15
_REPORTS: Final = 6
_LAG: Final = 3  # reports within which the shaft has followed
# One standard deviation of what each gets wrong: of the speed, turns and waves; of the current, the sensors
# of cheap controllers too
_SPEED_SHARE: Final = 0.04
_LOAD_SHARE: Final = 0.1
_TURN_SHARE_S: Final = 0.5  # of either, per rad/s of turn: the water meets the propeller from aside
_SPEED_FLOOR: Final = 0.5  # rad/s per V
_LOAD_FLOOR_A: Final = 0.25
_SILENT_S: Final = 2.0  # as a monitor of the current


class Shaft:
    """One motor. speed, load: the two models. usual: what a healthy one would show now, speed and current.

    drawn_a: the current of a healthy propeller at the measured speed.
    """

    def __init__(self) -> None:
        self.speed = HealthyModel(_SPEED_SIGMA, _WALK_S)
        self.load = HealthyModel(_LOAD_SIGMA, _WALK_S)
        self.usual = 0.0, 0.0
        self.drawn_a = 0.0
        self.heard_s = -math.inf
        self._duties: deque[float] = deque(maxlen=_REPORTS)

    def compare(self, reading: EscReading, duty: float, water_m_s: float, turn_rad_s: float) -> float:
        """Hold a report against the models. Returns the seconds since the last one, 0 where this one says
        nothing: astern, stopped, or while the speed changes.
        """
        elapsed_s, self.heard_s = min(reading.time_s - self.heard_s, 1.0), reading.time_s
        volt, duties = reading.voltage_v, self._duties
        duties.append(duty)
        is_steady = len(duties) == _REPORTS and max(duties) - min(duties) <= _STEADY
        if not is_steady or min(duties) < _DRIVEN or volt <= 0.0:
            return 0.0
        recent = list(duties)[-_LAG:]
        duty, off = 0.5 * (max(recent) + min(recent)), 0.5 * (max(recent) - min(recent))
        speed = abs(reading.shaft_rad_s) / volt
        regressors = [duty, duty * duty, water_m_s, 1.0]
        usual = max(self.speed.expected(regressors), 0.0)
        doubt = off / duty + _TURN_SHARE_S * abs(turn_rad_s)
        most, share = max(speed, usual), _SPEED_SHARE + doubt
        self.speed.hold(regressors, speed - usual, _SPEED_FLOOR**2 + (share * most) ** 2)
        of_usual, of_speed = (_loads(duty, one * volt, water_m_s) for one in (usual, speed))
        self.usual = usual, max(self.load.expected(of_usual), 0.0)
        self.drawn_a = drawn_a = max(self.load.expected(of_speed), 0.0)
        most_a, share = max(drawn_a, reading.current_a), _LOAD_SHARE + doubt
        self.load.hold(of_speed, reading.current_a - drawn_a, _LOAD_FLOOR_A**2 + (share * most_a) ** 2)
        return elapsed_s

    def learn(self, dt_s: float) -> None:
        """Take the last report for that of a healthy motor."""
        self.speed.learn(dt_s, is_driven=True)
        self.load.learn(dt_s, is_driven=True)


class ShaftEvidence:
    """What both motors' reports say for each hypothesis; those of one say nothing of the other."""

    def __init__(self) -> None:
        self._shafts = Shaft(), Shaft()
        self._speed_sizes, self._load_sizes = EffectSize(len(HYPOTHESES)), EffectSize(len(HYPOTHESES))
        self._now_s = 0.0

    def knows(self, *, is_left: bool) -> bool:
        """Whether this side's controller reports, and what is usual has been learned."""
        shaft = self._shafts[0 if is_left else 1]
        return shaft.speed.is_learned and self._now_s - shaft.heard_s < _SILENT_S

    def forget(self, hypothesis: int) -> None:
        """The fault begins now at the earliest."""
        self._speed_sizes.forget(hypothesis)
        self._load_sizes.forget(hypothesis)

    def update(
        self,
        escs: EscPair,
        duties: tuple[float, float],
        nav: NavState,
        gained: list[float],
        *,
        is_learning: bool,
    ) -> None:
        """Add each hypothesis's log likelihood ratio; a report that repeats the one before adds none."""
        self._now_s = nav.time_s
        for side, (shaft, reading, duty) in enumerate(zip(self._shafts, escs, duties, strict=True)):
            if reading is None or reading.time_s <= shaft.heard_s:
                continue
            elapsed_s = shaft.compare(reading, duty, nav.water_speed_m_s, nav.measured_yaw_rate_rad_s)
            if elapsed_s and shaft.speed.is_learned:
                self._weigh(side, shaft, gained)
            if elapsed_s and (is_learning or not shaft.speed.is_learned):
                shaft.learn(elapsed_s)

    def _weigh(self, side: int, shaft: Shaft, gained: list[float]) -> None:
        speed, load, drawn_a = shaft.speed, shaft.load, shaft.drawn_a
        usual, usual_a = shaft.usual
        healthy = sum(0.5 * min(one.residual**2 / one.variance, MOST_SQUARE) for one in (speed, load))
        for at, one in enumerate(HYPOTHESES):
            if one.is_left is (side == 1):
                continue
            (spin, spread), (torque, torque_spread) = one.spin, one.torque
            of_a = drawn_a if spin else usual_a  # one that stands has no current that is usual at its speed
            gained[at] += healthy
            gained[at] -= self._speed_sizes.cost(
                at, speed.residual, (spin - 1.0) * usual, spread * usual, speed.variance
            )
            gained[at] -= self._load_sizes.cost(
                at, load.residual, torque * of_a - drawn_a, torque_spread * of_a, load.variance
            )


def _loads(duty: float, speed_rad_s: float, water_m_s: float) -> list[float]:
    n = 0.01 * speed_rad_s
    return [duty * n * n, -duty * n * water_m_s, duty, 1.0]
