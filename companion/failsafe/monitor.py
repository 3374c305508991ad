"""All failsafes: ten times a second, which have fired, escalated or ended."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.failsafe.actions import RECOVERIES, Action
from companion.failsafe.endurance import Endurance
from companion.failsafe.escalation import Change, Escalation
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.motors.rudder_watch import RudderWatch
from companion.failsafe.motors.watch import MotorWatch
from companion.failsafe.presence import Planner
from companion.failsafe.recovery.transition_table import State
from companion.failsafe.table import ROWS, Condition, Row
from companion.geofence.monitor import FenceMonitor
from companion.rc.manual_input import ManualInput

PERIOD_S = 0.1
_SLACK_S = 1e-6
_JUDGED = (State.IDLE, State.COMPARING)  # where the motion says something about the motors
_POWER = int(Condition.BATTERY_CRITICAL | Condition.BATTERY_LOW | Condition.OUT_OF_RANGE)


class Alarm(NamedTuple):
    """A row has fired, escalated or ended. action: what is to be done, NONE where it is only told."""

    row: Row
    change: Change
    text: str
    action: Action


class Failsafes:
    """active: bits of what has fired and is not over. The other attributes feed the inputs."""

    def __init__(self, config: BoatConfig, sticks: ManualInput, rows: Sequence[Row] = ROWS) -> None:
        self.active = 0
        self.operator_heard_s = math.nan  # silence counts only after the first heartbeat
        self.planner = Planner()
        self.sticks = sticks
        self.endurance = Endurance()
        self.motors = MotorWatch(config)
        self.rudder = RudderWatch()
        self.fence = FenceMonitor()
        self._escalations = [Escalation(row) for row in rows]
        self._due_s, self._is_postponed = 0.0, False
        self._was_armed = False

    def is_due(self, now_s: float) -> bool:
        """Whether the next cycle is due."""
        return now_s >= self._due_s

    def postpone(self, until_s: float) -> None:
        """No cycle is due before. What is postponed is not postponed again."""
        if not self._is_postponed:
            self._due_s, self._is_postponed = until_s, True

    def is_active(self, condition: Condition) -> bool:
        """Whether this has fired and is not over."""
        return bool(self.active & int(condition))

    @property
    def pack_is_low(self) -> bool:
        """Whether the pack calls the boat home, for whatever reason."""
        return bool(self.active & _POWER)

    def renew_pack(self, share: float) -> None:
        """The pack has been changed or charged to this share: its failsafes are over. They fire again if the
        voltage is still too low.
        """
        for escalation in self._escalations:
            if int(escalation.row.condition) & _POWER:
                escalation.reset()
        self.active &= ~_POWER
        self.endurance.renew(share)

    def overrule(self) -> None:
        """The operator has chosen a mode: active failsafes take no further step."""
        for escalation in self._escalations:
            escalation.is_overruled = escalation.is_active
        self.planner.release()
        self.sticks.stop_watching()

    def update(self, inputs: FailsafeInputs) -> list[Alarm]:
        """One cycle."""
        now_s, setting, armed = inputs.now_s, inputs.config.failsafe, inputs.armed
        self._due_s, self._is_postponed = now_s + PERIOD_S - _SLACK_S, False
        alarms: list[Alarm] = []
        is_disarmed_now, self._was_armed = self._was_armed and not armed, armed
        for escalation in self._escalations:
            row = escalation.row
            if not armed and not row.guard.disarmed:
                if is_disarmed_now:
                    escalation.reset()
                    self.active &= ~int(row.condition)
                continue
            text = row.watch(inputs)
            if text and not escalation.is_active and row.guard.waits(inputs):
                text = ""
            if not text and not escalation.is_active:
                if escalation.text:
                    escalation.reset()
                continue
            if inputs.recovery not in _JUDGED and escalation.action in RECOVERIES:
                text = escalation.text  # its own recovery may be under way, whose motion says nothing
            change = escalation.update(text, setting, now_s)
            if change is Change.ENDS:
                self.active &= ~int(row.condition)
                alarms.append(Alarm(row, change, row.over, Action.NONE))
            elif change is not Change.STAYS:
                self.active |= int(row.condition)
                is_concerned = inputs.mode in row.guard.modes
                action = escalation.action if is_concerned else Action.NONE
                alarms.append(Alarm(row, change, escalation.text, action))
        return alarms
