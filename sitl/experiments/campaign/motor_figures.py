"""The boat's motor failsafe messages compared with the simulated motor faults."""

from typing import Final

from companion.failsafe.motors.hypotheses import HYPOTHESES, Fault
from sitl.run.mission_run import MissionRun
from sitl.world.truth import Truth

NEEDED: Final = 0.3  # of command: from here on a motor's thrust matters
_FAULTS: Final = {
    "off": Fault.DEAD,
    "stuck": Fault.BLOCKED,
    "weed": Fault.FOULED,
    "wrong": Fault.REVERSED,
    "slow": Fault.WEAK,
}
_SIDES: Final = {"motor_left": True, "motor_right": False}
_PREFIX: Final = "Failsafe: "
IN_TIME_S: Final = 8.0

_NAMED: Final = {_PREFIX + one.text: one for one in HYPOTHESES}
# Results of the boat's motor check, which count as well
_FOUND: Final = ("motor gives no thrust, right", "right gives no thrust", "is reversed: compensated")


def motor_figures(mission_run: MissionRun) -> dict[str, int | float | None]:
    """motor_alarms: how often a motor that works was said to fail, failsafes and trials together.

    For runs with one fault of a motor that some hypothesis is about, also: motor_needed_s, from the fault to
    the first command of NEEDED for that motor; motor_notice_s, from then to the first accusation (None:
    never); motor_named, 1 where that was within IN_TIME_S and of the right side and kind. A fault of a motor
    that is never needed, or ends the run at once, has no motor_named.
    """
    faults = [fault for fault in mission_run.scenario.faults if fault.what in _SIDES]
    events = mission_run.timeline.events
    said = [(event.time_s, event.text) for event in events if event.kind == "text"]
    if not faults:
        return {"motor_alarms": sum(_reports_fault(text) for _, text in said)}
    fault = faults[0]
    alarms = sum(_reports_fault(text) for time_s, text in said if time_s < fault.at_s)
    accusations = [(time_s, _NAMED[text]) for time_s, text in said if time_s >= fault.at_s and text in _NAMED]
    is_left = _SIDES[fault.what]
    alarms += sum(one.is_left is not is_left for _, one in accusations)
    out: dict[str, int | float | None] = {"motor_alarms": alarms}
    kind = _FAULTS.get(fault.kind)
    rows = mission_run.recorder.rows
    command = rows[:, Truth._fields.index("left_command" if is_left else "right_command")]
    needed = rows[(rows[:, 0] >= fault.at_s) & (abs(command) >= NEEDED), 0]
    if kind is None or not len(needed):
        return out
    needed_s = float(needed[0])
    out["motor_needed_s"] = needed_s - fault.at_s
    first = accusations[0] if accusations else None
    notice_s = None if first is None else first[0] - needed_s
    out["motor_notice_s"] = notice_s
    is_right = first is not None and first[1].is_left is is_left and first[1].fault is kind
    out["motor_named"] = int(is_right and notice_s is not None and notice_s <= IN_TIME_S)
    return out


def _reports_fault(text: str) -> bool:
    return text in _NAMED or any(words in text for words in _FOUND)
