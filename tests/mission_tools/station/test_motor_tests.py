"""Motors turned from the page: they turn while the page asks, and stop when it does not."""

import pytest
from blank_messages import blank
from boat_rig import Rig
from shore_rig import Shore

from companion.core.requests import ManualControl
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.outcome import Accepted, Outcome, Refused, Silent
from mission_tools.station.requests import BadRequestError
from mission_tools.station.setup.motor_tests import (
    ENDED,
    HELD_UP,
    NO_ANSWER,
    REFUSED,
    STOPPED,
    TURNING,
    MotorTests,
)
from mission_tools.station.texts import Text

LONGEST_S = 1.1  # a second, and what passes until the boat is polled
EVERY_S = 0.3  # how often the page repeats while a button is held


def press(
    shore: Shore, held_s: float = 0.0, name: str = "a", motor: str = "left", percent: float = 30.0
) -> None:
    shore.send("motor", {"motor": motor, "percent": percent, "press": name, "held_s": held_s})


def hold(shore: Shore, seconds: float, name: str = "a", motor: str = "left", percent: float = 30.0) -> None:
    """The page's requests while a button is held."""
    for number in range(round(seconds / EVERY_S)):
        press(shore, number * EVERY_S, name, motor, percent)
        shore.run(EVERY_S)


def turning(rig: Rig) -> tuple[bool, bool]:
    """Whether the emulated boat's motors are driven."""
    return bool(rig.world._motors.left), bool(rig.world._motors.right)


def until_rest(rig: Rig, shore: Shore, limit_s: float = 5.0) -> float:
    """How long the motors go on."""
    began_s = shore.now_s
    shore.until(lambda: turning(rig) == (False, False), limit_s)
    return shore.now_s - began_s


@pytest.fixture
def shore() -> Shore:
    return Shore(Rig()).ready()


@pytest.mark.parametrize(
    ("motor", "percent", "signs"),
    [("right", 30.0, (0, 1)), ("both", -50.0, (-1, -1)), ("turn", 15.0, (1, -1))],
)
def test_the_motors_asked_for_turn_and_no_other(
    shore: Shore, motor: str, percent: float, signs: tuple[int, int]
) -> None:
    (rig,) = shore.rigs
    hold(shore, 1.5, motor=motor, percent=percent)
    left, right = rig.world._motors.left, rig.world._motors.right
    assert (left > 0) - (left < 0) == signs[0]
    assert (right > 0) - (right < 0) == signs[1]
    assert max(abs(left), abs(right)) == pytest.approx(abs(percent) / 100.0, abs=0.01)
    assert {one.ok for one in shore.answers} == {True}


def test_a_held_button_turns_the_motor_without_a_gap_and_is_announced_once(shore: Shore) -> None:
    (rig,) = shore.rigs
    hold(shore, 0.6)
    gaps = 0
    for number in range(2, 30):
        press(shore, number * EVERY_S)
        for _ in range(8):
            shore.run(0.04)
            gaps += not turning(rig)[0]
    assert gaps == 0
    assert rig.peer.texts.count("Motor test: left 30 %") == 1
    assert rig.world.truth.yaw_rate_rad_s > 0.0  # the left propeller pushes the bow to starboard


def test_letting_go_stops_the_motor_at_once(shore: Shore) -> None:
    (rig,) = shore.rigs
    hold(shore, 1.5)
    assert turning(rig) == (True, False)
    shore.send("motor_stop")
    assert until_rest(rig, shore) <= 0.1
    shore.run(1.0)
    assert (shore.answers[-1].ok, shore.answers[-1].text) == (True, STOPPED)
    assert not rig.boat.motor_test.is_running


def test_the_motor_stops_within_a_second_of_the_page_falling_silent() -> None:
    rig = Rig()
    shore = Shore(rig, loss=0.4, seed=3).ready()
    hold(shore, 3.0)
    shore.until(lambda: turning(rig)[0] or shore.now_s > 1e3, 20.0)
    assert until_rest(rig, shore) <= LONGEST_S
    shore.run(5.0)
    assert turning(rig) == (False, False)


def test_the_motor_stops_within_a_second_of_the_link_breaking(shore: Shore) -> None:
    (rig,) = shore.rigs
    hold(shore, 1.5)
    shore.ends[0].loss = 1.0
    assert turning(rig)[0]
    began_s = shore.now_s
    while turning(rig)[0]:  # the button is still held
        assert shore.now_s - began_s <= LONGEST_S
        press(shore, 1.5 + shore.now_s - began_s)
        shore.run(0.1)


def test_a_request_that_was_held_up_does_not_turn_a_motor(shore: Shore) -> None:
    (rig,) = shore.rigs
    hold(shore, 0.6)
    shore.run(3.0)  # the page's requests come all at once, after somebody let go
    for number in range(2, 12):
        press(shore, number * EVERY_S)
    shore.run(0.1)
    assert turning(rig) == (False, False)
    assert shore.answers[-10].text == HELD_UP
    assert {one.text for one in shore.answers[-9:]} == {ENDED}


def test_a_boat_armed_by_somebody_else_meanwhile_refuses_in_its_own_words(shore: Shore) -> None:
    (rig,) = shore.rigs
    hold(shore, 0.6)
    assert rig.arm() == dialect.MAV_RESULT_ACCEPTED
    press(shore, 0.6)
    shore.until(lambda: not shore.answers[-1].ok, 3.0)
    assert shore.answers[-1].text == "disarm first"
    rig.boat.vehicle.request(ManualControl(0.0, 0.0))
    assert turning(rig) == (False, False)


@pytest.mark.parametrize(
    "wrong",
    [
        {"motor": "propeller"}, {"motor": 3}, {"percent": 50.1}, {"percent": 0.0}, {"percent": "30"},
        {"percent": float("nan")}, {"press": ""}, {"press": "x" * 65}, {"press": None}, {"held_s": None},
    ],
)  # fmt: skip
def test_a_malformed_request_is_refused_and_nothing_is_sent(wrong: dict[str, object]) -> None:
    sent: list[Message] = []
    asked = {"motor": "left", "percent": 30.0, "press": "a", "held_s": 0.0} | wrong
    with pytest.raises(BadRequestError):
        MotorTests(Address(1, 1), Address(250, 190), sent.append).turn(asked, lambda _: None, 0.0)
    assert sent == []


class Script:
    """Motor tests of a boat of which a test says what it sends."""

    def __init__(self) -> None:
        self.sent: list[Message] = []
        self.answers: list[Outcome] = []
        self.motors = MotorTests(Address(1, 1), Address(250, 190), self.sent.append)

    def turn(self, now_s: float, press: str = "a", held_s: float = 0.0) -> None:
        asked = {"motor": "left", "percent": 30.0, "press": press, "held_s": held_s}
        self.motors.turn(asked, self.answers.append, now_s)

    def ack(self, now_s: float, result: int = dialect.MAV_RESULT_ACCEPTED, target: int = 250) -> None:
        command = dialect.MAV_CMD_DO_MOTOR_TEST
        self.motors.on_ack(blank("command_ack", command=command, result=result, target_system=target), now_s)


def test_two_durations_alternate_as_the_boat_takes_an_equal_command_for_a_repetition() -> None:
    script = Script()
    for number in range(4):
        script.turn(0.3 * number, held_s=0.3 * number)
    assert [one.param4 for one in script.sent] == [
        pytest.approx(0.95 if number % 2 == 0 else 1.0) for number in range(4)
    ]
    assert [(one.param1, one.param2, one.param3) for one in script.sent] == [(3.0, 0.0, 30.0)] * 4
    script.ack(1.0, target=9)
    assert script.answers == []
    script.ack(1.0)
    assert script.answers == [Accepted(TURNING)] * 4


def test_a_press_that_was_stopped_does_not_turn_the_motor_again() -> None:
    script = Script()
    script.turn(0.0)
    script.motors.stop(script.answers.append, 0.2)
    script.turn(0.3, held_s=0.3)
    assert script.answers == [Refused(ENDED)]
    script.turn(0.4, "b")
    assert script.answers[1:] == [Accepted(STOPPED)], "the next press ends the wait for rest"


def test_a_stop_is_sent_four_times_and_answered_once_the_boat_is_at_rest() -> None:
    script = Script()
    script.turn(0.0)
    script.ack(0.0)
    script.motors.stop(script.answers.append, 1.0)
    for tenth in range(10, 20):
        script.motors.poll(0.1 * tenth, True)
    assert [one.param4 for one in script.sent[1:]] == [0.0] * 4
    script.ack(2.0)
    script.motors.poll(2.4, True)  # by the heartbeat of the test
    assert len(script.answers) == 1
    script.motors.poll(2.6, True)  # armed by somebody else
    assert script.answers[1:] == [Accepted(STOPPED)]


def test_without_an_answer_a_turn_is_given_up_after_three_seconds_and_a_stop_after_six() -> None:
    script = Script()
    script.turn(0.0)
    script.motors.poll(2.9, False)
    assert script.answers == []
    script.motors.poll(3.0, False)
    script.motors.stop(script.answers.append, 4.0)
    script.motors.poll(9.9, False)
    assert len(script.answers) == 1
    script.motors.poll(10.0, False)
    assert script.answers == [Silent(NO_ANSWER)] * 2


def test_a_refusal_waits_for_the_boats_reason_and_ends_the_press() -> None:
    script = Script()
    script.turn(0.0)
    script.ack(0.1, dialect.MAV_RESULT_DENIED)
    script.motors.on_text(Text(4, "Something else"))
    script.motors.on_text(Text(5, "Motor test: whatever"))
    script.motors.on_text(Text(4, "Motor test: disarm first"))
    script.turn(0.2, "b")
    assert script.answers == [Refused(ENDED)]
    script.motors.poll(0.39, False)
    assert len(script.answers) == 1
    script.motors.poll(0.4, False)
    assert script.answers[1:] == [Refused("disarm first")]
    script.turn(0.5, held_s=0.5)
    assert script.answers[2:] == [Refused(ENDED)]
    script.turn(0.6, "c")
    script.ack(0.7, dialect.MAV_RESULT_DENIED)
    script.motors.poll(1.0, False)
    assert script.answers[3:] == [Refused(REFUSED)]
