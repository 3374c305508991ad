"""The steps of a calibration, by single messages of a boat."""

import math
from typing import Any

import pytest
from blank_messages import blank

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.messages import Calibration
from mission_tools.station.outcome import Accepted, Cancelled, Outcome, Refused, Silent
from mission_tools.station.setup import calibrations
from mission_tools.station.setup.calibrations import Calibrations
from mission_tools.station.texts import Text

ACCEPTED, IN_PROGRESS = dialect.MAV_RESULT_ACCEPTED, dialect.MAV_RESULT_IN_PROGRESS
FAILED = dialect.MAV_RESULT_FAILED
GYRO = dialect.MAV_CMD_PREFLIGHT_CALIBRATION
START, CANCEL = dialect.MAV_CMD_DO_START_MAG_CAL, dialect.MAV_CMD_DO_CANCEL_MAG_CAL
KEEP = dialect.MAV_CMD_DO_ACCEPT_MAG_CAL


class Boat:
    """Calibrations of a boat of which a test says what it sends."""

    def __init__(self) -> None:
        self.sent: list[Message] = []
        self.answers: list[Outcome] = []
        self.calibrations = Calibrations(Address(1, 1), Address(250, 190), self.sent.append)
        self.now_s = 100.0

    def start(self, kind: str) -> None:
        self.calibrations.start(kind, self.answers.append, self.now_s)

    def cancel(self) -> None:
        self.calibrations.cancel(self.answers.append, self.now_s)

    def keep(self) -> None:
        self.calibrations.keep(self.answers.append, self.now_s)

    def ack(self, command: int, result: int, *, progress: int = 0, target: int = 250) -> None:
        told = blank("command_ack", command=command, result=result, progress=progress, target_system=target)
        self.calibrations.on_ack(told, self.now_s)

    def progress(self, percent: int, compass: int = 0) -> None:
        told = blank("mag_cal_progress", completion_pct=percent, compass_id=compass, completion_mask=[0] * 10)
        self.calibrations.on_progress(told, self.now_s)

    def report(self, **values: Any) -> None:  # noqa: ANN401 (fields of MAG_CAL_REPORT)
        self.calibrations.on_report(blank("mag_cal_report", **({"cal_status": 4} | values)), self.now_s)

    def say(self, text: str, severity: int = 5) -> None:
        self.calibrations.on_text(Text(severity, text), self.now_s)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.25)):
            self.now_s += 0.25
            self.calibrations.poll(self.now_s)

    @property
    def now(self) -> Calibration:
        return self.calibrations.now


def running(kind: str, command: int) -> Boat:
    """A boat that has begun."""
    boat = Boat()
    boat.start(kind)
    boat.ack(command, ACCEPTED if kind == "compass" else IN_PROGRESS)
    assert boat.now.state == "running"
    assert boat.answers == [Accepted(calibrations.STARTED)]
    boat.answers.clear()
    return boat


def test_a_start_is_repeated_every_second_until_it_is_given_up() -> None:
    boat = Boat()
    assert boat.calibrations.latest is None
    boat.start("gyro")
    boat.start("gyro")
    assert boat.answers == [Refused(calibrations.UNDER_WAY)]
    boat.run(7.75)
    assert [(one.command, one.param1, one.confirmation) for one in boat.sent] == [
        (GYRO, 1.0, number) for number in range(calibrations.TRIES)
    ]
    assert boat.now.state == "asked"
    boat.run(0.25)
    assert boat.answers[1:] == [Silent(calibrations.NO_ANSWER)]
    assert (boat.now.state, boat.now.text) == ("unknown", calibrations.NO_ANSWER)


def test_its_progress_is_followed_to_its_end_and_the_boats_text_tells_it() -> None:
    boat = running("gyro", GYRO)
    boat.ack(GYRO, IN_PROGRESS, progress=40)
    boat.ack(GYRO, IN_PROGRESS, progress=90, target=9)
    boat.report()
    assert boat.now.percent == 40
    boat.ack(GYRO, IN_PROGRESS, progress=140)
    assert boat.now.percent == 100
    boat.ack(GYRO, ACCEPTED)
    boat.ack(GYRO, FAILED)  # of a repetition
    boat.run(0.25)
    assert boat.now.state == "running"
    boat.say("PreArm: Gyro calibrated", 4)
    boat.say("INS_GYROFFS_Z 0.1 -> 0.2", 6)
    boat.say("Gyro calibrated")
    boat.run(0.25)
    assert (boat.now.state, boat.now.text, boat.now.percent) == ("done", "Gyro calibrated", 100)
    assert boat.now.lines == ["INS_GYROFFS_Z 0.1 -> 0.2"]


@pytest.mark.parametrize(
    ("result", "state"), [(FAILED, "failed"), (6, "cancelled"), (dialect.MAV_RESULT_DENIED, "failed")]
)
def test_a_start_that_the_boat_refuses_ends_in_its_words(result: int, state: str) -> None:
    boat = Boat()
    boat.start("gyro")
    boat.ack(GYRO, result)
    boat.say("Something else", 5)
    boat.say("The propellers turn", 4)
    boat.run(0.5)
    assert boat.answers == [Refused("The propellers turn")]
    assert (boat.now.state, boat.now.text, boat.now.percent) == (state, "The propellers turn", None)
    boat.start("gyro")
    boat.ack(GYRO, FAILED)
    boat.run(0.5)
    assert boat.now.text == "The boat refuses this"


def test_a_text_tells_the_end_where_the_answer_is_lost() -> None:
    for text, state in (("Thruster calibration done", "done"), ("Thruster calibration aborted: x", "failed")):
        boat = running("thrusters", dialect.MAV_CMD_USER_1)
        boat.say(f"Failsafe: {text}", 4)
        boat.say(text, 6)
        boat.run(1.0)
        assert boat.now.state == "running"
        boat.say(text)
        boat.run(0.5)
        assert (boat.now.state, boat.now.text) == (state, text)


def test_a_boat_that_says_nothing_is_silent_and_its_end_in_the_end_unknown() -> None:
    boat = running("gyro", GYRO)
    boat.run(5.0)
    assert boat.now.state == "running"
    boat.run(0.25)
    assert boat.now.state == "silent"
    boat.ack(GYRO, IN_PROGRESS, progress=50)
    assert boat.now.state == "running"
    boat.run(4.75)
    assert (boat.now.state, boat.now.percent) == ("running", 50)
    boat.run(0.25)
    assert (boat.now.state, boat.now.percent) == ("unknown", None)
    boat.start("gyro")
    assert boat.now.state == "asked"


def test_the_compass_waits_with_its_result_until_it_is_kept() -> None:
    boat = running("compass", START)
    boat.keep()
    assert boat.answers.pop() == Refused(calibrations.NOTHING_TO_KEEP)
    boat.progress(30)
    boat.progress(70, compass=1)
    assert boat.now.percent == 30
    boat.ack(START, ACCEPTED)  # of a repetition: the report tells the end
    boat.report(fitness=12.34, ofs_x=101.26, ofs_y=-7.0, ofs_z=math.nan)
    boat.run(0.5)
    assert boat.now.state == "waiting"
    assert (boat.now.error_mg, boat.now.offset_mg, boat.now.percent) == (12.3, [101.3, -7.0, 0.0], 100)
    boat.report(cal_status=5)
    boat.keep()
    boat.keep()
    assert boat.answers == [Refused(calibrations.UNDER_WAY)]
    boat.ack(KEEP, IN_PROGRESS)
    boat.ack(KEEP, ACCEPTED)
    assert boat.answers[1:] == [Accepted(calibrations.KEPT)]
    assert boat.now.state == "done"


def test_a_result_whose_report_was_lost_can_be_kept() -> None:
    boat = running("compass", START)
    boat.run(6.0)
    assert boat.now.state == "silent"
    boat.keep()
    boat.ack(KEEP, ACCEPTED)
    assert (boat.answers, boat.now.state) == ([Accepted(calibrations.KEPT)], "done")


@pytest.mark.parametrize(("waits_s", "state"), [(0.0, "waiting"), (1.0, "done")])
def test_only_a_repeated_keeping_that_fails_means_that_the_first_was_heard(
    waits_s: float, state: str
) -> None:
    boat = running("compass", START)
    boat.report()
    boat.run(0.5)
    boat.keep()
    boat.run(waits_s)
    boat.ack(KEEP, FAILED)
    assert boat.now.state == state
    assert isinstance(boat.answers[0], Accepted if state == "done" else Refused)


@pytest.mark.parametrize(("values", "state"), [({"autosaved": 1}, "done"), ({"cal_status": 5}, "failed")])
def test_a_report_ends_the_compass_calibration(values: dict[str, int], state: str) -> None:
    boat = running("compass", START)
    boat.report(**values)
    boat.run(0.5)
    assert boat.now.state == state


def test_the_text_of_a_result_to_be_kept_counts_before_its_report() -> None:
    boat = running("compass", START)
    boat.say("Compass calibration to be accepted: 12 mG")
    boat.run(0.5)
    assert boat.now.state == "waiting"


@pytest.mark.parametrize(
    ("kind", "command", "result", "percent"),
    [("gyro", GYRO, IN_PROGRESS, 25), ("compass", START, ACCEPTED, 0)],
)
def test_the_answer_to_a_start_tells_the_progress_of_what_is_in_progress(
    kind: str, command: int, result: int, percent: int
) -> None:
    boat = Boat()
    boat.start(kind)
    boat.ack(command, result, progress=25)
    assert (boat.now.state, boat.now.percent) == ("running", percent)


def test_progress_is_an_answer_to_a_start_whose_own_is_lost() -> None:
    boat = Boat()
    boat.start("compass")
    boat.progress(10)
    assert boat.answers == [Accepted(calibrations.STARTED)]


def test_what_is_under_way_is_cancelled_and_answered() -> None:
    boat = Boat()
    boat.cancel()
    assert boat.answers.pop() == Refused(calibrations.NOTHING_TO_CANCEL)
    boat.start("compass")
    boat.cancel()
    assert boat.answers == [Cancelled(calibrations.CANCELLED)]
    assert [one.command for one in boat.sent] == [START, CANCEL]
    boat.ack(CANCEL, FAILED)
    assert boat.now.state == "asked"
    boat.ack(CANCEL, ACCEPTED)
    assert boat.answers[1:] == [Accepted(calibrations.CANCELLED)]
    assert (boat.now.state, boat.now.percent) == ("cancelled", None)
    boat.report(fitness=9.0)
    assert boat.now.error_mg is None, "of a calibration that is over"
    boat.cancel()
    assert boat.answers[2:] == [Refused(calibrations.NOTHING_TO_CANCEL)]


def test_the_changes_are_kept_up_to_a_bound() -> None:
    boat = running("gyro", GYRO)
    for number in range(30):
        boat.say(f"P{number} 1 -> 2", 6)
        boat.say(f"p{number} 1 -> 2", 6)
    assert len(boat.now.lines) == 20
