"""Setting a parameter: on real boats, and on boats that answer oddly."""

import math
from typing import Any

import pytest
from boat_rig import Rig
from shore_rig import Shore
from test_download import known, snapshot, until_here, value

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.messages import Answer
from mission_tools.station.outcome import Accepted, Cancelled, Outcome, Refused, Silent
from mission_tools.station.parameters import setting
from mission_tools.station.parameters.metadata import Bit, Choice, Description, read_descriptions
from mission_tools.station.parameters.setting import Settings, refusal_of
from mission_tools.station.parameters.values import Value

REAL32, INT8, INT32, UINT8 = 9, 2, 6, 1
BOAT, OWN = Address(1, 1), Address(250, 190)


def ready(rig: Rig, **options: Any) -> Shore:  # noqa: ANN401
    shore = Shore(rig, **options)
    until_here(shore, 60.0)
    shore.until(lambda: snapshot(shore).texts == "here", 60.0)
    packed = snapshot(shore).packed
    assert packed is not None
    shore.boat().parameters.describe(packed, read_descriptions(*packed))
    return shore


def set_(shore: Shore, name: Any, number: Any) -> Answer:  # noqa: ANN401
    return shore.ask("set_parameter", {"name": name, "value": number})


def stored(rig: Rig, name: str) -> float:
    row = next(row for row in rig.boat.parameters.rows if row.name == name)
    return rig.boat.parameters.value(row)


def test_a_value_is_on_board_when_the_page_says_so() -> None:
    rig = Rig()
    shore = ready(rig, loss=0.2, seed=5)
    answer = set_(shore, "CRUISE_SPEED", 0.85)
    assert (answer.ok, answer.text) == (True, "CRUISE_SPEED is now 0.85")
    assert answer.result == {"name": "CRUISE_SPEED", "value": 0.85}
    assert stored(rig, "CRUISE_SPEED") == pytest.approx(0.85)
    assert known(shore)["CRUISE_SPEED"] == pytest.approx(0.85)


def test_what_does_not_fit_is_refused_in_a_sentence_and_not_sent() -> None:
    rig = Rig()
    shore = ready(rig)
    before = known(shore)
    misfits: list[tuple[Any, Any, str]] = [
        ("CRUISE_SPEED", 1e9, "CRUISE_SPEED: 1000000000 m/s is outside 0.001 to 20 m/s"),
        ("CRUISE_SPEED", math.nan, "no number that fits 32 bits"),
        ("CRUISE_SPEED", 1e300, "no number that fits 32 bits"),
        ("CRUISE_SPEED", 10**400, "no number that fits 32 bits"),
        ("LOG_DISARMED", 0.5, "LOG_DISARMED: 0.5 is no whole number"),
        ("LOG_DISARMED", 5, "LOG_DISARMED: 5 is outside 0 to 1"),
        ("LOG_DISARMED", 500, "LOG_DISARMED: 500 is outside -128 to 127"),
        ("AHRS_ORIENTATION", 3, "AHRS_ORIENTATION cannot be changed"),
        ("NO_SUCH", 3, "The boat has no parameter NO_SUCH"),
        ("CRUISE_SPEED", "1", "CRUISE_SPEED: value is missing or is no number"),
        ("CRUISE_SPEED", True, "CRUISE_SPEED: value is missing or is no number"),
        ("CRUISE_SPEED", None, "CRUISE_SPEED: value is missing or is no number"),
        (None, 1, "name: expected the name of a parameter"),
        ("A" * 17, 1, "name: expected the name of a parameter"),
        ("A\nB", 1, "name: expected the name of a parameter"),
    ]
    for name, number, text in misfits:
        answer = set_(shore, name, number)
        assert not answer.ok
        assert text in answer.text
    shore.run(0.5)
    assert known(shore) == before


def test_nothing_is_set_while_the_boat_is_armed() -> None:
    rig = Rig()
    shore = ready(rig).ready()
    before = stored(rig, "CRUISE_SPEED")
    assert shore.ask("arm").ok
    shore.run(1.5)
    answer = set_(shore, "CRUISE_SPEED", 0.5)
    assert (answer.ok, answer.text) == (False, "The boat is armed: disarm it first")
    shore.run(1.0)
    assert stored(rig, "CRUISE_SPEED") == before
    assert shore.ask("disarm").ok
    shore.run(1.5)
    assert set_(shore, "CRUISE_SPEED", 0.5).ok


class Script:
    """Settings of a boat of which a test says what it sends."""

    def __init__(self) -> None:
        self.sent: list[Message] = []
        self.settings = Settings(BOAT, OWN, self.sent.append)
        self.answers: list[tuple[Outcome, Value | None]] = []
        self.now_s = 0.0

    def ask(self, number: float, name: str = "A", kind: int = REAL32) -> None:
        self.settings.ask(name, number, kind, False, lambda *answer: self.answers.append(answer), self.now_s)

    def hear(self, number: float, name: str = "A", kind: int = REAL32) -> None:
        self.settings.on_value(name, Value(number, kind), self.now_s)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.05)):
            self.now_s += 0.05
            self.settings.poll(self.now_s)


def test_a_silent_boat_is_asked_some_times_and_then_given_up() -> None:
    script = Script()
    script.ask(1.0)
    script.run(20.0)
    assert len(script.sent) == setting.TRIES
    assert script.answers == [
        (Silent("No answer from the boat. Whether A has changed is not known: look at it again"), None)
    ]


def test_the_old_value_of_a_list_under_way_is_no_answer() -> None:
    script = Script()
    script.ask(1.0)
    script.hear(0.0)
    script.run(0.6)
    assert script.answers == []
    script.hear(1.0)
    assert [type(outcome) for outcome, _ in script.answers] == [Accepted]


def test_a_boat_that_keeps_another_value_without_a_reason_is_believed_the_second_time() -> None:
    script = Script()
    script.ask(9.0)
    script.hear(5.0)
    script.hear(5.0)  # twice by two links is once
    script.run(0.9)
    assert script.answers == []
    script.run(0.2)
    assert len(script.sent) == 2
    script.hear(5.0)
    script.run(1.0)
    assert script.answers == [(Refused("The boat keeps A at 5"), Value(5.0, REAL32))]


def test_a_reason_before_or_after_the_value_is_told() -> None:
    for text_first in (True, False):
        script = Script()
        script.ask(9.0)
        if text_first:
            script.settings.on_text("A: 9 is outside 0..5", script.now_s)
        script.hear(5.0)
        if not text_first:
            script.settings.on_text("A: 9 is outside 0..5", script.now_s)
        script.settings.on_text("ABC: something else", script.now_s)
        script.run(1.0)
        assert [outcome.text for outcome, _ in script.answers] == [
            "A: 9 is outside 0..5. The boat keeps A at 5"
        ]


@pytest.mark.parametrize("target", [(0, 0), (250, 190), (9, 9)])
def test_a_param_error_is_the_answer_if_it_is_ours(target: tuple[int, int]) -> None:
    script = Script()
    script.ask(9.0)
    error = dialect.MAVLink_param_error_message(*target, b"A", -1, dialect.MAV_PARAM_ERROR_READ_ONLY)
    script.settings.on_error(error, script.now_s)
    script.run(0.9)
    told = [outcome.text for outcome, _ in script.answers]
    assert told == ([] if target == (9, 9) else ["A: the boat cannot change this parameter"])


def test_a_newer_value_replaces_the_older_one() -> None:
    script = Script()
    script.ask(1.0)
    script.ask(2.0)
    assert [outcome for outcome, _ in script.answers] == [Cancelled()]
    script.hear(2.0)
    assert [type(outcome) for outcome, _ in script.answers] == [Cancelled, Accepted]


def test_many_at_once_are_bounded_and_each_is_answered() -> None:
    script = Script()
    for number in range(setting.MOST + 5):
        script.ask(1.0, f"P{number}")
    assert len(script.answers) == 5
    script.run(10.0)
    assert len(script.answers) == setting.MOST + 5


@pytest.mark.parametrize(
    ("number", "kind", "described", "text"),
    [
        (5.0, REAL32, Description(low=0.0, high=4.0, unit="m"), "P: 5 m is outside 0 to 4 m"),
        (5.0, REAL32, Description(low=6.0), "P: 5 is outside 6 to ∞"),
        (4.0, REAL32, Description(low=0.0, high=4.0), ""),
        (0.1, REAL32, Description(low=float(value("A", 0.1, 0, 1).param_value)), ""),
        (-1.0, INT8, Description(low=0.0, high=9.0, values=[Choice(-1.0, "Off")]), ""),
        (3.0, INT8, Description(values=[Choice(0.0, "Off"), Choice(1.0, "On")]), "P: 3 is not one of 0, 1"),
        (3.0, INT8, Description(values=[Choice(0.0, "Off")], bits=[Bit(0, "x")]), ""),
        (-1.0, UINT8, Description(), "P: -1 is outside 0 to 255"),
        (16777217.0, INT32, Description(), "P: 16777217 cannot be sent exactly"),
        (16777218.0, INT32, Description(), ""),
        (1.0, REAL32, Description(read_only=True), "P cannot be changed"),
    ],
)
def test_the_rules_of_type_and_description(
    number: float, kind: int, described: Description, text: str
) -> None:
    refusal = refusal_of("P", number, kind, False, described)
    assert refusal.startswith(text)
    assert bool(refusal) == bool(text)
