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
_DRIVING = 0.1  # of the cubes' sum: less load says nothing about the current
_STEADY = 0.3  # of command, both sides: a motor that is reversed draws what it likes
_IDLE_SHARE = 0.02  # command below which a motor draws nothing
_PALTRY = 0.6  # of the current that such commands have drawn: one of two motors is not there
_EXCESSIVE = 1.7
_ODD_S = 4.0  # for which it must be so
_LOPSIDED = 0.5  # of the difference in thrust that turns the boat hardest
_TURNS_RAD_S = 0.05
_SAME = 0.1  # difference in thrust that points at neither side

NO_HEADWAY, STUCK = 1, 2  # guidance's verdicts


class MotorWatch:
    """Two signs that a motor does not pull: much steering without a turn, and a current that is too small.

    A boat with a dead motor is held on its heading by ever more steering: the difference in thrust grows, and
    no turn comes of it. A pack's current grows about as the cube of the command (torque ∝ n², duty ∝ n), so
    current over the cubes' sum is a constant of the boat: it is learned, and a propeller that is gone or a
    wire that is off shows as a fall, weed as a rise. Wind and set neither last nor are strong enough.
    """

    __slots__ = (
        "_difference",
        "_driven_s",
        "_gain_a",
        "_idle_a",
        "_left",
        "_lopsided_s",
        "_odd_s",
        "_ratio",
        "_right",
        "_turn_rad_s",
        "fault",
    )

    def __init__(self) -> None:
        self._idle_a = 0.0
        self._gain_a = 0.0  # current of both motors at full command
        self._driven_s = 0.0
        self.fault = ""
        self.reset()

    def reset(self) -> None:
        """Begin to judge anew; what is known of the boat stays."""
        self.fault = ""
        self._left = self._right = 0.0
        self._difference = self._turn_rad_s = 0.0
        self._ratio = 1.0
        self._odd_s = self._lopsided_s = 0.0

    def update(
        self, left: float, right: float, battery: BatteryReading | None, nav: NavState | None, dt_s: float
    ) -> None:
        """Take the commands of the last dt_s and what has come of them; `fault` is then the judgement."""
        blend = min(dt_s / _SMOOTH_S, 1.0)
        self._left += blend * (left - self._left)
        self._right += blend * (right - self._right)
        self._difference += blend * (left * abs(left) - right * abs(right) - self._difference)
        if nav is not None:
            self._turn_rad_s += blend * (nav.yaw_rate_rad_s - self._turn_rad_s)
        lopsided = abs(self._difference)
        turn_rad_s = math.copysign(self._turn_rad_s, self._turn_rad_s * self._difference)
        is_lopsided = nav is not None and lopsided > _LOPSIDED and turn_rad_s < _TURNS_RAD_S
        self._lopsided_s = self._lopsided_s + dt_s if is_lopsided else 0.0
        if battery is not None and battery.current_a is not None:
            self._weigh(left, right, battery.current_a, blend, dt_s)
        self.fault = self._judge(left, right)

    def _weigh(self, left: float, right: float, current_a: float, blend: float, dt_s: float) -> None:
        if abs(left) < _IDLE_SHARE and abs(right) < _IDLE_SHARE:
            self._idle_a += blend * (current_a - self._idle_a)
            return
        cubes = abs(left) ** 3 + abs(right) ** 3
        is_steady = abs(left - self._left) + abs(right - self._right) < _STEADY
        if cubes < _DRIVING or not is_steady:
            self._odd_s = 0.0
            return
        gain_a = max(current_a - self._idle_a, 0.0) / cubes
        if self._driven_s >= _ENOUGH_S:
            self._ratio += blend * (gain_a / max(self._gain_a, 1e-3) - self._ratio)
        is_odd = not _PALTRY < self._ratio < _EXCESSIVE
        self._odd_s = self._odd_s + dt_s if is_odd else 0.0
        if not is_odd:
            self._driven_s += dt_s
            self._gain_a += dt_s / min(self._driven_s, _LEARN_S) * (gain_a - self._gain_a)

    def _judge(self, left: float, right: float) -> str:
        if self._odd_s >= _ODD_S and self._ratio >= _EXCESSIVE:
            return "Motors draw too much, weed on a propeller"
        if self._odd_s >= _ODD_S or self._lopsided_s >= _ODD_S:
            if abs(self._difference) < _SAME:
                return "A motor does not pull"
            return f"{'Left' if abs(left) > abs(right) else 'Right'} motor does not pull"
        return ""


def motor_failing(signs: "Signs") -> str:
    """A motor is driven, and what should come of it does not."""
    return signs.motors.fault


def no_headway(signs: "Signs") -> str:
    """Full ahead, and the water is as fast as the boat."""
    return "No headway: the water is as fast as the boat" if signs.headway == NO_HEADWAY else ""


def stuck(signs: "Signs") -> str:
    """Full ahead, and something holds the boat."""
    return "Stuck: something holds the boat" if signs.headway == STUCK else ""


def capsized(signs: "Signs") -> str:
    """Keel up, or nearly; told by a heading sensor that also gives roll and pitch."""
    reading, limit_rad = signs.heading, signs.config.failsafe.capsize_rad
    if reading is None or limit_rad <= 0.0 or reading.roll_rad is None or reading.pitch_rad is None:
        return ""
    if not max(abs(reading.roll_rad), abs(reading.pitch_rad)) > limit_rad:
        return ""
    return f"Capsized: roll {math.degrees(reading.roll_rad):.0f}, pitch {math.degrees(reading.pitch_rad):.0f}"
