"""Which motor has failed, inferred from turn rate, speed and current, and from controllers that report."""

import math
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.control.allocation import rudder_effect
from companion.core.readings import BatteryReading, EscPair, GnssFix
from companion.core.state import NavState
from companion.failsafe.motors.evidence import MotorEvidence
from companion.failsafe.motors.hypotheses import HYPOTHESES, Fault, Hypothesis

# Evidence, in nats, that proves a fault: one false alarm in e^16 independent samples, three weeks of them
PROVED: Final = 16.0
MARGIN: Final = 4.0  # nats ahead of every other hypothesis that counts: odds of 50 to 1
CLEARED_S: Final = (
    180.0  # for which a motor check that finds both healthy, or a comparison both alike, stands
)
# Without a break: a shaft thrown into reverse draws as a blocked one does at first
PROVED_S: Final = 0.8
AKIN_MARGIN: Final = 2.0  # between two names of what is treated alike: odds of 7 to 1
# For which dead and weak may stay alike: at half of its command a weak motor hardly turns in its dead band
_NAMED_S: Final = 5.0
# Evidence for a fouled propeller that is worth a comparison. Failing motors reached it 0.3 s after 6 nats,
# which healthy ones reached once in four hours.
UNSURE: Final = 10.0
# Evidence that proves it while the motors are compared, and soon after. In healthy runs it falls then.
COMPARED: Final = 13.0
_COMPARE_AGAIN_S: Final = 4.0  # after the start of the last one, which takes 2.4 s
_STEERED: Final = 0.5  # of one motor's thrust, between the two: with more, a hull without wind turns,
_TURNS_RAD_S: Final = 0.05  # like this at least
_CHECK_S: Final = 6.0  # of steering for nothing, for boats without a measured current
_SMOOTH_S: Final = 1.0
_WITHOUT_CURRENT: Final = (Fault.DEAD, Fault.REVERSED)


class MotorWatch:
    """Which motor has failed, and how: decided by `MotorEvidence`.

    It tells two motors apart by the turn. A boat with one motor gets no verdict: without thrust it makes no
    headway, which guidance/stall_detector.py detects.

    verdict: the hypothesis that is proved, until evidence for healthy motors has outweighed it.
    needs_comparison: whether a propeller seems fouled: each motor alone would prove it, and tell which one.
    """

    def __init__(self, config: BoatConfig) -> None:
        self._evidence = MotorEvidence(config)
        self._cleared_until_s = -math.inf
        self._compare_from_s = self._alike_until_s = -math.inf
        self.verdict: Hypothesis | None = None
        self.needs_comparison = self._is_compared = False
        self._steered = self._turn_rad_s = self._helpless_s = self._proved_s = 0.0
        self._suspect: Hypothesis | None = None

    @property
    def needs_check(self) -> bool:
        """Whether only a motor check can tell if both motors pull.

        A motor that gives no thrust and a wind against it look alike to a boat that measures nothing of it,
        while the commands stand still.
        """
        evidence = self._evidence
        is_told = evidence.has_current or all(evidence.shafts.knows(is_left=one) for one in (True, False))
        return self._helpless_s >= _CHECK_S and not is_told

    def reset(self) -> None:
        """Drop the verdict and its evidence; keep the learned gains."""
        self.verdict = None
        self.pause()

    def rearm(self) -> None:
        """The boat is disarmed: the next voyage begins without a verdict or the result of a motor check."""
        self.reset()
        self._evidence.rearm()
        self._cleared_until_s = self._compare_from_s = self._alike_until_s = -math.inf

    def pause(self) -> None:
        """The motion says nothing of the motors for now. A verdict stands."""
        self._evidence.restart()
        self._steered = self._turn_rad_s = self._helpless_s = self._proved_s = 0.0
        self._suspect = None
        self.needs_comparison = False

    def compare(self, now_s: float) -> bool:
        """A comparison begins. Whether the left motor is the likelier one, which is driven first."""
        self._compare_from_s = now_s + _COMPARE_AGAIN_S
        against = self._evidence.against
        return HYPOTHESES[against.index(max(against))].is_left

    def clear(self, now_s: float) -> None:
        """A motor check has found both healthy: for CLEARED_S that outweighs what is inferred under way."""
        self.reset()
        self._cleared_until_s = now_s + CLEARED_S

    def update(
        self,
        left: float,
        right: float,
        nav: NavState | None,
        fix: GnssFix | None,
        battery: BatteryReading | None,
        config: BoatConfig,
        now_s: float,
        dt_s: float,
        rudder: float = 0.0,
        escs: EscPair = (None, None),
    ) -> None:
        """Take the commands of the last dt_s and what has come of them, and decide."""
        if nav is None or not config.drive.has_pair:
            return
        evidence = self._evidence
        steered = 0.0
        if config.drive.has_rudder:
            water_m_s = nav.water_speed_m_s
            steered = rudder * rudder_effect(0.5 * (left + right), water_m_s, config.drive, config.speed)
        if config.parts.motors.driver in ("esc", "vesc"):
            # Its current grows with the cube of the command, and it cuts off a motor that stalls
            battery = None
        evidence.update(left, right, nav, fix, battery, config.thrusters.asymmetry, dt_s, steered, escs)
        if now_s < self._cleared_until_s:
            evidence.acquit()
            self._helpless_s = 0.0
            return
        against = evidence.against
        was_compared, self._is_compared = self._is_compared, now_s < self._compare_from_s
        if was_compared and not self._is_compared and self.verdict is None and self._are_alike():
            self._alike_until_s = now_s + CLEARED_S
            evidence.relearn_current()
        is_open = self.verdict is None and not self._is_compared and now_s >= self._alike_until_s
        self.needs_comparison = is_open and self._seems_fouled()
        if self.verdict is not None:
            at = HYPOTHESES.index(self.verdict)
            against[at] = min(against[at], PROVED)
            if against[at] <= 0.0:
                self.verdict = None
                evidence.acquit()
            return
        self._watch_steering(left, right, nav.measured_yaw_rate_rad_s, dt_s)
        (suspect, akin), before = self._decide(), self._suspect
        self._suspect = suspect
        lasts = suspect is not None and before is not None and suspect.is_akin(before)
        self._proved_s = self._proved_s + dt_s if lasts else 0.0
        if self._proved_s >= (PROVED_S if akin is None else _NAMED_S):
            self.verdict = akin or suspect

    def _seems_fouled(self) -> bool:
        """Whether a fouled propeller is the likeliest fault, though not proved."""
        against = self._evidence.against
        most = max(against)
        at = against.index(most)
        return self._evidence.knows_current and HYPOTHESES[at].fault is Fault.FOULED and most >= UNSURE

    def _are_alike(self) -> bool:
        """Whether both motors draw as much more: the model errs, or both propellers are worn."""
        left, right = (
            self._evidence.against[at] for at, one in enumerate(HYPOTHESES) if one.fault is Fault.FOULED
        )
        return abs(left - right) < MARGIN

    def _decide(self) -> tuple[Hypothesis | None, Hypothesis | None]:
        """The hypothesis that is proved, and ahead of every other. Where only an akin one is close: which of
        the two claims less.
        """
        against = self._evidence.against
        counted = [at for at, one in enumerate(HYPOTHESES) if self._is_told(one)]
        first = max(counted, key=against.__getitem__)
        best, lead = HYPOTHESES[first], against[first]
        if lead < (COMPARED if self._is_compared and best.fault is Fault.FOULED else PROVED):
            return None, None
        akin = None
        for at in counted:
            other, ahead = HYPOTHESES[at], lead - against[at]
            if at == first or ahead >= MARGIN:
                continue
            if not other.is_akin(best):
                return None, None
            if ahead < AKIN_MARGIN:
                akin = best if best.has_thrust else other
        return best, akin

    def _is_told(self, one: Hypothesis) -> bool:
        """Whether what is measured can tell this fault from others."""
        if self._evidence.shafts.knows(is_left=one.is_left) or one.fault in _WITHOUT_CURRENT:
            return True
        return self._evidence.has_current and one.fault is not Fault.LOST

    def _watch_steering(self, left: float, right: float, turn_rad_s: float, dt_s: float) -> None:
        """How long the boat has been steered hard without turning that way."""
        blend = min(dt_s / _SMOOTH_S, 1.0)
        self._steered += blend * (left * abs(left) - right * abs(right) - self._steered)
        self._turn_rad_s += blend * (turn_rad_s - self._turn_rad_s)
        is_turning = self._turn_rad_s * math.copysign(1.0, self._steered) >= _TURNS_RAD_S
        is_helpless = abs(self._steered) > _STEERED and not is_turning
        self._helpless_s = self._helpless_s + dt_s if is_helpless else 0.0
