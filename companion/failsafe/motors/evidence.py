"""The evidence for each hypothesis about the motors, against healthy ones: one CUSUM each.

For every measurement of turn rate, speed and current, and of each shaft that reports, each hypothesis has a
residual with a known variance. So have healthy motors in an unknown wind, which may push and turn the hull
within its rate of change. The log likelihood ratios are summed as `companion.core.evidence` does. How large a
fault is, is learned meanwhile (`EffectSize`). Neighbouring samples, whose errors are alike, count for WEIGHT
of independent ones.

A fix tells the speed of some time ago: the speed is predicted up to the time of the fix, and no further.
"""

import math
from collections import deque
from typing import Final, NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.evidence import LEARNING, MOST_SQUARE, FaultEvidence
from companion.core.readings import BatteryReading, EscPair, GnssFix
from companion.core.state import COMPASS_FAULTS, GNSS_FAULTS, EstimateFault, NavState
from companion.failsafe.motors.current import MotorCurrent
from companion.failsafe.motors.hypotheses import HYPOTHESES, WEIGHT, EffectSize, Fault
from companion.failsafe.motors.motion_filter import MotionFilter
from companion.failsafe.motors.shaft import ShaftEvidence

# Tuned on sample seeds 21, 101 to 103, 301 and 302 of examples/campaigns/motors_*.toml
VAGUE: Final = 0.5  # of a sample of the motion, for weed: in gusts a weak motor and a wind look alike

_SHAFT_S: Final = 0.1  # lag of the thrust behind the command,
_SPIN_S: Final = 0.2  # and of the shaft's speed, as the current shows it (sampled ten times a second)
_ADVANCE: Final = 0.4  # of the duty that holds cruise speed: below it the propeller brakes at that speed
_LEAST_THROTTLE: Final = 0.05  # at cruise speed: a lower value was not measured
_ASTERN: Final = 0.7  # of the thrust ahead (0.6 to 0.8 for fixed propellers)
# Of the stall current, at full command: what weed adds. Its drag is a friction, independent of the speed
WEED: Final = 0.1
_DRIVEN: Final = 0.1  # of command: less says nothing about the current
_TURN_DECAY_S: Final = 0.8  # decay of the turn rate, 1/s (Nomoto: 0.8 to 2 s),
_SPEED_DECAY_S: Final = 0.25  # and of the speed ahead
# The estimator takes missing thrust for a current within seconds, so its current of some time ago counts
_WATER_S: Final = 15.0
# rad/s² per √s that wind adds to the turn: maximum likelihood over healthy runs in gusts of 7 to 12 m/s
_TURN_WANDER: Final = 0.08
_TURN_SIGMA: Final = 0.0055  # rad/s: of the gyro
_SPEED_WANDER: Final = 0.025  # the same for the speed ahead, in cruise speeds
_SPEED_SIGMA: Final = 0.06  # m/s: of the receiver
# Correlation time of the wind's moment. Healthy runs are likeliest at 8 to 10 s, and at 6 s still likelier
# than with a random walk; the shorter, the sooner a motor that turns the hull the wrong way is named.
_TURN_CORRELATION_S: Final = 6.0
_SPEED_CORRELATION_S: Final = math.inf  # an error of the estimated current stays for minutes
_SILENT_S: Final = 2.0  # twenty readings of a common monitor
_MOST_PENDING: Final = 50  # cycles, 5 s: the receiver is taken for lost earlier
_SLACK_S: Final = 1e-6
_PRIOR: Final = 200.0  # samples that the configured gains are worth: seconds of steering or speeding up

# Of the motion for each hypothesis, and the spread of its effect
_WEIGHTS: Final = tuple(
    (VAGUE if one.fault is Fault.FOULED else 1.0, one.thrust_spread) for one in HYPOTHESES
)

# Plain numbers: an IntFlag's arithmetic costs microseconds
_NO_COMPASS: Final = COMPASS_FAULTS | int(EstimateFault.HEADING_LOST)
_NO_GNSS: Final = GNSS_FAULTS | int(EstimateFault.POSITION_LOST)


class _Push(NamedTuple):
    """What moves the hull ahead for one cycle, until a fix tells the speed at that time."""

    time_s: float
    heading_rad: float
    push: float
    changes: tuple[float, ...]
    dt_s: float


class MotorEvidence:
    """`against` has the evidence for each of HYPOTHESES, in nats. has_current: whether a current tells.

    shafts: of controllers that report.
    """

    def __init__(self, config: BoatConfig) -> None:
        speed, handling = config.speed, config.handling
        count = len(HYPOTHESES)
        self._evidence = FaultEvidence(count)
        self.against = self._evidence.against
        self.has_current = False
        cruise_m_s = speed.cruise_m_s
        self._advance_s_m = _ADVANCE * speed.cruise_throttle / cruise_m_s
        # At cruise speed a drag ∝ u² decays with 2 drag / u; thrust and drag are equal there.
        push = 2.0 * (1.0 - _ADVANCE) * max(speed.cruise_throttle, _LEAST_THROTTLE) ** 2
        ahead = 0.5 * cruise_m_s / (config.estimation.surge_time_s * push)
        turning = handling.turn_rate_rad_s * _TURN_DECAY_S / (1.0 + _ASTERN)
        self._turn = MotionFilter(
            count, turning, _PRIOR, _TURN_WANDER, _TURN_SIGMA, _TURN_CORRELATION_S, _TURN_DECAY_S
        )
        self._speed = MotionFilter(
            count,
            ahead,
            _PRIOR,
            _SPEED_WANDER * cruise_m_s,
            _SPEED_SIGMA,
            _SPEED_CORRELATION_S,
            _SPEED_DECAY_S,
        )
        self._current = MotorCurrent()
        self.shafts = ShaftEvidence()
        self._sizes = EffectSize(count), EffectSize(count), EffectSize(count)  # of turn, speed and current
        self._pending: deque[_Push] = deque(maxlen=_MOST_PENDING)
        self._changes_turn, self._changes_ahead = [0.0] * count, [0.0] * count
        self._duties = (0.0, 0.0)
        self._shafts, self._spins = [0.0, 0.0], [0.0, 0.0]
        self._battery_s = self._heard_s = self._fix_s = -math.inf
        self._is_late = False  # the current, until the boat is disarmed
        self._nav_faults = 0
        self._current_a = math.nan
        self._water_north_m_s = self._water_east_m_s = 0.0
        self._since_battery_s = self._since_fix_s = 0.0

    @property
    def knows_current(self) -> bool:
        """Whether a current tells, and what is usual has been learned."""
        return self.has_current and self._current.is_learned

    def rearm(self) -> None:
        """Another voyage begins: the current counts again."""
        self._is_late = False

    def restart(self) -> None:
        """Judge anew, as after something that is not modelled; what was learned of the boat stays."""
        self._turn.restart()
        self._speed.restart()
        self._heard_s = -math.inf  # nobody listened meanwhile: that is no silence
        self.acquit()

    def acquit(self) -> None:
        """Drop all evidence: whatever has happened so far, no motor had failed."""
        for at in range(len(HYPOTHESES)):
            self._forget(at)

    def relearn_current(self) -> None:
        """Drop all evidence, and learn anew what healthy motors draw: it was not what was learned."""
        self.acquit()
        self._current = MotorCurrent()

    def _forget(self, at: int) -> None:
        """The fault begins now at the earliest."""
        self.against[at] = 0.0
        self._turn.forget(at)
        self._speed.forget(at)
        for size in (*self._sizes, self.shafts):
            size.forget(at)

    def update(
        self,
        left: float,
        right: float,
        nav: NavState,
        fix: GnssFix | None,
        battery: BatteryReading | None,
        asymmetry: float,
        dt_s: float,
        steered: float = 0.0,
        escs: EscPair = (None, None),
    ) -> None:
        """Take the commands that have held for dt_s until now, and what has come of them.

        asymmetry: by which commands astern are enlarged for the thrust that is lost there. steered: the
        rudder's moment, in shares of full steering. escs: what left and right controller report.
        """
        self._spin(left, right, dt_s)
        water_m_s = nav.water_speed_m_s
        share = min(dt_s / _WATER_S, 1.0)
        self._water_north_m_s += share * (nav.current_north_m_s - self._water_north_m_s)
        self._water_east_m_s += share * (nav.current_east_m_s - self._water_east_m_s)
        astern = min(_ASTERN * asymmetry * asymmetry, 1.0)
        turning = steered * (1.0 + astern)  # two motors at full steering: one ahead, one astern
        self._predict(water_m_s, astern, nav.heading_rad, nav.time_s, dt_s, turning)
        if nav.faults & ~self._nav_faults & (_NO_COMPASS | _NO_GNSS):
            self.acquit()  # what that sensor has told was wrong before it was found out
        self._nav_faults = nav.faults
        is_learning = max(self.against) < LEARNING
        gained = [0.0] * len(HYPOTHESES)
        if nav.faults & _NO_COMPASS:
            self._turn.restart()
        elif self._turn.correct(nav.measured_yaw_rate_rad_s - nav.wave_rad_s, dt_s, is_learning=is_learning):
            _weigh(self._turn, self._sizes[0], gained)
        self._take_fix(fix, nav, gained, is_learning, dt_s)
        self._take_current(battery, water_m_s, gained, is_learning, dt_s)
        self.shafts.update(escs, self._duties, nav, gained, is_learning=is_learning)
        for at, gain in enumerate(gained):
            if not self._evidence.add(at, WEIGHT * gain, dt_s):
                self._forget(at)

    def _spin(self, left: float, right: float, dt_s: float) -> None:
        """The shafts follow the commands of the last time."""
        thrust_lag = 1.0 - math.exp(-dt_s / _SHAFT_S)
        spin_lag = 1.0 - math.exp(-dt_s / _SPIN_S)
        for side, duty in enumerate(self._duties):
            self._shafts[side] += thrust_lag * (duty - self._shafts[side])
            self._spins[side] += spin_lag * (duty - self._spins[side])
        self._duties = (left, right)

    def _push(self, shaft: float, water_m_s: float, astern: float) -> float:
        """Thrust of one propeller, in shares of what full command gives at rest."""
        push = abs(shaft) * (shaft - self._advance_s_m * water_m_s)
        return push if push > 0.0 else astern * push

    def _predict(
        self, water_m_s: float, astern: float, heading_rad: float, now_s: float, dt_s: float, turning: float
    ) -> None:
        pushes = [self._push(shaft, water_m_s, astern) for shaft in self._shafts]
        for at, hypothesis in enumerate(HYPOTHESES):
            side = 0 if hypothesis.is_left else 1
            shaft = hypothesis.gain * self._shafts[side]
            push = pushes[side] if hypothesis.gain == 1.0 else self._push(shaft, water_m_s, astern)
            change = hypothesis.thrust * push - pushes[side]
            self._changes_ahead[at] = change
            self._changes_turn[at] = change if hypothesis.is_left else -change
        self._turn.predict(pushes[0] - pushes[1] + turning, self._changes_turn, dt_s)
        self._pending.append(
            _Push(now_s, heading_rad, pushes[0] + pushes[1], tuple(self._changes_ahead), dt_s)
        )

    def _take_fix(
        self, fix: GnssFix | None, nav: NavState, gained: list[float], is_learning: bool, dt_s: float
    ) -> None:
        """The speed through the water, from each new velocity over ground less the current."""
        self._since_fix_s += dt_s
        if fix is None or nav.faults & (_NO_GNSS | _NO_COMPASS):
            self._speed.restart()
            self._pending.clear()
            return
        if fix.time_s == self._fix_s or fix.north_m_s is None or fix.east_m_s is None:
            return
        self._fix_s = fix.time_s
        heading_rad = nav.heading_rad
        while self._pending and self._pending[0].time_s <= fix.time_s + _SLACK_S:
            heading_rad = (push := self._pending.popleft()).heading_rad
            self._speed.predict(push.push, push.changes, push.dt_s)
        north_m_s, east_m_s = fix.north_m_s - self._water_north_m_s, fix.east_m_s - self._water_east_m_s
        ahead_m_s = north_m_s * math.cos(heading_rad) + east_m_s * math.sin(heading_rad)
        if self._speed.correct(ahead_m_s, self._since_fix_s, is_learning=is_learning):
            _weigh(self._speed, self._sizes[1], gained)
        self._since_fix_s = 0.0

    def _take_current(
        self,
        battery: BatteryReading | None,
        water_m_s: float,
        gained: list[float],
        is_learning: bool,
        dt_s: float,
    ) -> None:
        """A reading that repeats the one before is that of a monitor that hangs: it tells nothing. A monitor
        that was silent may be late from then on.
        """
        self._since_battery_s += dt_s
        if battery is None or battery.current_a is None or not math.isfinite(battery.current_a):
            self.has_current = False
            return
        self._is_late |= _SILENT_S < battery.time_s - self._heard_s < math.inf
        self._heard_s = battery.time_s
        if battery.time_s == self._battery_s or battery.current_a == self._current_a or self._is_late:
            self.has_current = self.has_current and self._since_battery_s < _SILENT_S and not self._is_late
            return
        self._battery_s, self._current_a = battery.time_s, battery.current_a
        elapsed_s, self._since_battery_s = self._since_battery_s, 0.0
        self.has_current = True
        current = self._current
        current.compare(self._duties, self._spins, water_m_s, battery.current_a)
        residual, variance = current.residual, current.variance
        healthy = 0.5 * min(residual * residual / variance, MOST_SQUARE)
        is_driven = abs(self._duties[0]) > _DRIVEN or abs(self._duties[1]) > _DRIVEN
        if is_learning or not (is_driven and current.is_learned):
            current.learn(elapsed_s, is_driven=is_driven)
        if not current.is_learned:
            return
        for at, hypothesis in enumerate(HYPOTHESES):
            side = 0 if hypothesis.is_left else 1
            drawn = current.drawn[side]
            duty = self._duties[side]
            change, spread = (hypothesis.load - 1.0) * drawn, hypothesis.spread * drawn
            if hypothesis.fault is Fault.REVERSED:
                change = 2.0 * current.water_a * duty * water_m_s
            elif hypothesis.fault is Fault.WEAK:
                # duty and shaft speed go with the gain, the flow against the propeller does not
                gain, flow = hypothesis.gain, current.water_a * duty * water_m_s
                change = max(gain * (gain * (drawn + flow) - flow), 0.0) - drawn
                spread = -hypothesis.spread * change
            elif hypothesis.fault is Fault.FOULED:
                change = WEED * current.stall_a * abs(duty)
                spread = hypothesis.spread * change
            gained[at] += healthy - self._sizes[2].cost(at, residual, change, spread, variance)


def _weigh(motion: MotionFilter, sizes: EffectSize, gained: list[float]) -> None:
    """Add each hypothesis's log likelihood ratio against healthy motors."""
    variance, residual = motion.variance, motion.residual
    healthy = 0.5 * min(residual * residual / variance, MOST_SQUARE)
    for at, (other, (weight, spread)) in enumerate(zip(motion.residuals, _WEIGHTS, strict=True)):
        effect = residual - other
        gained[at] += weight * (healthy - sizes.cost(at, residual, effect, spread * effect, variance))
