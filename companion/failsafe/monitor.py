"""All failsafes: run ten times a second, they say what has fired; the vehicle acts on it."""

from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.modes import Mode
from companion.failsafe.actions import ON_THE_SPOT, Action
from companion.failsafe.escalation import Escalation, Move
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.table import ROWS, Concerns, Condition
from companion.rc.manual_input import ManualInput

PERIOD_S = 0.1
_SLACK_S = 1e-6
_PLANNER_LOST = int(Condition.PLANNER_LOST)  # plain numbers: an IntFlag's arithmetic costs microseconds
_HELM_LOST = int(Condition.HELM_LOST)
_POWER = int(Condition.BATTERY_CRITICAL | Condition.BATTERY_LOW | Condition.OUT_OF_RANGE)


class Alarm(NamedTuple):
    """Something has fired, climbed, or is over. action: what the vehicle is to do now, NONE to tell only."""

    ladder: Escalation
    move: Move
    text: str
    action: Action


class Failsafes:
    """`signs` is what the owners write, `active` the bits of what has fired and is not over."""

    __slots__ = ("_due_s", "_ladders", "_was_armed", "_watched", "active", "signs")

    def __init__(self, config: BoatConfig, sticks: ManualInput) -> None:
        self.signs = FailsafeInputs(config, sticks)
        self.active = 0
        self._ladders = [Escalation(row) for row in ROWS]
        self._watched = [(one, one.row.watch, one.row.is_watched_disarmed) for one in self._ladders]
        self._due_s = 0.0
        self._was_armed = False

    def is_due(self, now_s: float) -> bool:
        """Whether it is time to look again."""
        return now_s >= self._due_s

    def is_active(self, condition: Condition) -> bool:
        """Whether this has fired and is not over."""
        return bool(self.active & int(condition))

    @property
    def pack_is_low(self) -> bool:
        """Whether the pack calls the boat home, for whatever reason."""
        return bool(self.active & _POWER)

    def renew_pack(self, share: float) -> None:
        """The pack has been changed or charged and has this share of its charge: what was told of it is over.
        It is told anew if the voltage is still too low."""
        for ladder in self._ladders:
            if int(ladder.row.condition) & _POWER:
                ladder.reset()
        self.active &= ~_POWER
        self.signs.endurance.renew(share)
        self.signs.shortfall = ""

    def overrule(self) -> None:
        """The operator has chosen a mode: what is active keeps to the steps that it has taken."""
        for ladder in self._ladders:
            ladder.is_overruled = ladder.is_active
        self.signs.planner.release()
        self.signs.sticks.stop_watching()

    def update(self, is_clearing: bool) -> list[Alarm]:
        """Look once. is_clearing: a drill runs; nothing is judged of the motors then."""
        signs = self.signs
        now_s, setting, armed = signs.now_s, signs.config.failsafe, signs.armed
        self._due_s = now_s + PERIOD_S - _SLACK_S
        self._learn(is_clearing)
        alarms: list[Alarm] = []
        is_disarmed_now, self._was_armed = self._was_armed and not armed, armed
        for ladder, watch, is_watched_disarmed in self._watched:
            if not armed and not is_watched_disarmed:
                if is_disarmed_now:
                    ladder.reset()
                    self.active &= ~int(ladder.row.condition)
                continue
            text = watch(signs)
            if not text and not ladder.is_active:
                if ladder.text:
                    ladder.reset()
                continue
            if is_clearing and ladder.action in ON_THE_SPOT:
                text = ladder.text
            move = ladder.update(text, setting, now_s)
            if move is not Move.STAYS:
                alarms.append(self._alarm(ladder, move))
        return alarms

    def _alarm(self, ladder: Escalation, move: Move) -> Alarm:
        row = ladder.row
        if move is Move.ENDS:
            self.active &= ~int(row.condition)
            return Alarm(ladder, move, row.over, Action.NONE)
        self.active |= int(row.condition)
        is_concerned = concerns(row.concerns, self.signs.mode)
        return Alarm(ladder, move, ladder.text, ladder.action if is_concerned else Action.NONE)

    def _learn(self, is_clearing: bool) -> None:
        signs = self.signs
        if signs.planner.is_steering and not signs.is_guided and not self.active & _PLANNER_LOST:
            signs.planner.release()
        if not signs.mode.is_by_hand and not self.active & _HELM_LOST:
            signs.sticks.stop_watching()
        signs.endurance.learn(signs.battery, signs.nav, signs.config, PERIOD_S)
        if not signs.armed:
            signs.motors.rearm()
        if is_clearing or signs.gives_way or signs.failed_motor:  # no model fits a boat on one motor
            signs.motors.pause()
        else:
            signs.motors.update(
                signs.left,
                signs.right,
                signs.nav,
                signs.fix,
                signs.battery,
                signs.config,
                signs.now_s,
                PERIOD_S,
            )


def concerns(kind: Concerns, mode: Mode) -> bool:
    """Whether something is done in this mode."""
    if kind is Concerns.STEERED_BY_POSITION:
        return mode.needs_position
    return kind is Concerns.ALL or not mode.is_by_hand
