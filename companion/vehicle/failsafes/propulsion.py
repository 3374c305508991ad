"""Whether the motors do what they are told, and whether the boat gets on."""

import math
from typing import TYPE_CHECKING

from companion.sensors.readings import BatteryReading
from companion.state import NavState

if TYPE_CHECKING:
    from companion.vehicle.failsafes.signs import Signs

_SMOOTH_S = 2.0
_LEARN_S = 60.0
_ENOUGH_S = 20.0  # of driving before the current is judged
_POWER = 2.25
_DRIVING = 0.25  # of the load of one motor: less says nothing about the current
_STEADY = 0.3  # of command, both sides: a motor that is reversed draws what it likes
_IDLE_SHARE = 0.02  # command below which a motor draws nothing
_PALTRY = 0.6  # of the current that such commands have drawn: one of two motors is not there
_ABSENT = 0.35  # what was most of the load draws nothing: no need to look for long
_GLARING = 3.0  # times as fast
_EXCESSIVE = 2.5  # a hull held fast by wind and set asks for up to 1.7
_ODD_S = 4.0  # for which it must be so
_WELL_S = 8.0  # of steady driving as it should be, and the fault is over
_LOPSIDED = 0.85  # of one motor's thrust, between the two: gusts are met with less
_ASTRAY = 0.5
_ASTRAY_S = 2.5
_BALANCED = 0.3  # of command: the mean of the two drives the boat nowhere to speak of
_FAST_SHARE = 0.35  # of cruise speed
_TURNS_RAD_S = 0.05
_HELPLESS_S = 6.0  # steered like that, and hardly any turn: whatever the current says
_HELPLESS_RAD_S = 0.1
_EVEN = 0.5  # of one motor's thrust: with more between the two, nothing is learned of what is normal
_SAME = 0.1  # difference in thrust that points at neither side

NO_HEADWAY, STUCK, AGROUND = 1, 2, 3  # guidance's verdicts


class MotorWatch:
    """What motors show that do not pull, or pull the wrong way.

    fault, in words: what a motor takes from the pack is its duty times a torque ∝ n², and n lags behind the
    duty, so that current over the sum of |duty|^2.25 is nearly a constant of the boat: it is learned, and a
    wire that is off or a propeller that is gone shows as a fall, weed as a rise. Where none is measured, only
    steering at its limit that turns nothing is left to go by: a boat with a dead motor is held on its heading
    by ever more of it.

    accuses_left, accuses_right: steering bears out that it is this one, whatever the current says.

    is_astray: the boat is steered hard, does not turn, and runs ahead or astern although the two motors
    balance each other. One runs the wrong way round: the more the boat is steered, the worse it gets.
    """

    __slots__ = (
        "_astray_s",
        "_difference",
        "_driven_s",
        "_gain_a",
        "_helpless_s",
        "_idle_a",
        "_left",
        "_lopsided_s",
        "_odd_s",
        "_ratio",
        "_right",
        "_turn_rad_s",
        "_well_s",
        "accuses_left",
        "accuses_right",
        "fault",
        "heeds_current",
        "is_astray",
    )

    def __init__(self) -> None:
        self.heeds_current = True  # not once motors that it accused were tried, and pulled
        self._idle_a = 0.0
        self._gain_a = 0.0  # current of both motors at full command
        self._driven_s = 0.0
        self.fault = ""
        self.accuses_left = self.accuses_right = False
        self.is_astray = False
        self.reset()

    def reset(self) -> None:
        """Begin to judge anew; what is known of the boat stays."""
        self.fault = ""
        self.accuses_left = self.accuses_right = False
        self.is_astray = False
        self.pause()

    def pause(self) -> None:
        """The motors do something else for a while. The judgement stands until they have proved it wrong."""
        self._left = self._right = 0.0
        self._difference = self._turn_rad_s = 0.0
        self._ratio = 1.0
        self._odd_s = self._lopsided_s = self._well_s = self._astray_s = self._helpless_s = 0.0

    def update(
        self,
        left: float,
        right: float,
        battery: BatteryReading | None,
        nav: NavState | None,
        cruise_m_s: float,
        dt_s: float,
    ) -> None:
        """Take the commands of the last dt_s and what has come of them, and judge."""
        blend = min(dt_s / _SMOOTH_S, 1.0)
        is_steady = abs(left - self._left) + abs(right - self._right) < _STEADY
        self._left += blend * (left - self._left)
        self._right += blend * (right - self._right)
        self._difference += blend * (left * abs(left) - right * abs(right) - self._difference)
        if nav is not None:
            self._look(nav, cruise_m_s, blend, dt_s)
        is_telling = is_steady and _load(left, right) >= _DRIVING
        if self.heeds_current and battery is not None and battery.current_a is not None:
            self._weigh(left, right, battery.current_a, is_telling, dt_s)
        if fault := self._judge(left, right):
            self.fault, self._well_s = fault, 0.0
        elif self.fault and is_telling and self._odd_s + self._lopsided_s + self._helpless_s == 0.0:
            self._well_s += dt_s
            if self._well_s >= _WELL_S:
                self.fault = ""

    def _look(self, nav: NavState, cruise_m_s: float, blend: float, dt_s: float) -> None:
        """How the boat answers to being steered."""
        self._turn_rad_s += blend * (nav.yaw_rate_rad_s - self._turn_rad_s)
        turn = math.copysign(self._turn_rad_s, self._turn_rad_s * self._difference)
        steered = 0.0 if turn >= _TURNS_RAD_S else abs(self._difference)
        is_helpless = abs(self._difference) > _LOPSIDED and turn < _HELPLESS_RAD_S
        self._helpless_s = self._helpless_s + dt_s if is_helpless else 0.0
        self._lopsided_s = self._lopsided_s + dt_s if steered > _LOPSIDED else 0.0
        set_ahead_m_s = nav.set_along_m_s(nav.heading_rad)
        fast_m_s = _FAST_SHARE * cruise_m_s
        runs = abs(nav.surge_m_s) > fast_m_s and abs(nav.surge_m_s - set_ahead_m_s) > 0.5 * fast_m_s
        is_balanced = abs(self._left + self._right) < 2.0 * _BALANCED
        is_astray = steered > _ASTRAY and runs and is_balanced
        self._astray_s = self._astray_s + dt_s if is_astray else 0.0
        if self._astray_s >= _ASTRAY_S:
            self.is_astray = True

    def _weigh(self, left: float, right: float, current_a: float, is_telling: bool, dt_s: float) -> None:
        if abs(left) < _IDLE_SHARE and abs(right) < _IDLE_SHARE:
            self._idle_a += min(dt_s / _SMOOTH_S, 1.0) * (current_a - self._idle_a)
        if not is_telling:
            return  # what was odd before is neither confirmed nor refuted
        gain_a = max(current_a - self._idle_a, 0.0) / _load(left, right)
        if self._driven_s >= _ENOUGH_S:
            self._ratio += min(dt_s / _SMOOTH_S, 1.0) * (gain_a / max(self._gain_a, 1e-3) - self._ratio)
            self._lopsided_s = 0.0  # the current knows better
        is_odd = not _PALTRY < self._ratio < _EXCESSIVE
        haste = _GLARING if self._ratio < _ABSENT else 1.0
        self._odd_s = self._odd_s + haste * dt_s if is_odd else 0.0
        if not is_odd and not self.fault and abs(self._difference) < _EVEN:
            self._driven_s += dt_s
            self._gain_a += dt_s / min(self._driven_s, _LEARN_S) * (gain_a - self._gain_a)

    def _judge(self, left: float, right: float) -> str:
        if self._odd_s >= _ODD_S and self._ratio >= _EXCESSIVE:
            return "Motors draw too much, weed on a propeller"
        if self._odd_s >= _ODD_S or self._lopsided_s >= _ODD_S or self._helpless_s >= _HELPLESS_S:
            if abs(self._difference) < _SAME:
                return "A motor does not pull"
            is_left, is_sure = abs(left) > abs(right), abs(self._difference) > _EVEN
            self.accuses_left, self.accuses_right = is_left and is_sure, is_sure and not is_left
            return f"{'Left' if is_left else 'Right'} motor does not pull"
        return ""


def _load(left: float, right: float) -> float:
    """What two duties take from the pack, in shares of one motor's full load."""
    load: float = abs(left) ** _POWER + abs(right) ** _POWER
    return load


def motor_failing(signs: "Signs") -> str:
    """A motor is driven, and what should come of it does not."""
    return signs.lame or signs.motors.fault


def steering_lost(signs: "Signs") -> str:
    """The motors work, and do not turn the boat: one of them runs the wrong way."""
    return "Steering lost: a motor runs the wrong way" if signs.motors.is_astray else ""


def no_headway(signs: "Signs") -> str:
    """Full ahead, and the water is as fast as the boat."""
    return "No headway: the water is as fast as the boat" if signs.headway == NO_HEADWAY else ""


def stuck(signs: "Signs") -> str:
    """Full ahead, and something holds the boat."""
    return "Stuck: something holds the boat" if signs.headway == STUCK else ""


def aground(signs: "Signs") -> str:
    """Close to a line, driven hard, and held."""
    return "Aground: held at the shore" if signs.headway == AGROUND else ""


def capsized(signs: "Signs") -> str:
    """Keel up, or nearly; told by a heading sensor that also gives roll and pitch."""
    reading, limit_rad = signs.heading, signs.config.failsafe.capsize_rad
    if reading is None or limit_rad <= 0.0 or reading.roll_rad is None or reading.pitch_rad is None:
        return ""
    if not max(abs(reading.roll_rad), abs(reading.pitch_rad)) > limit_rad:
        return ""
    return f"Capsized: roll {math.degrees(reading.roll_rad):.0f}, pitch {math.degrees(reading.pitch_rad):.0f}"
