"""The configured parts one after the other, through the functions that open them on the boat."""

import math
from collections.abc import Callable, Iterator
from itertools import chain, repeat
from pathlib import Path

import gpiozero
import pytest
from doctor_tree import Examine
from fake_clock import FakeClock
from msgspec import json
from msgspec.structs import replace
from twins.pins import PinBoard
from twins.pulses import PI_4, plug_in_pwm
from twins.rover import SET_UP

from companion.app.doctor.by_hand import nudge_motors
from companion.app.doctor.findings import Verdict
from companion.app.doctor.parts import (
    PARTS,
    LivePart,
    check_autopilot,
    check_escs,
    check_part,
    part_findings,
)
from companion.app.status_file import BoatStatus
from companion.config.actuators import MotorsPart
from companion.config.boat_config import BoatConfig, Parts
from companion.config.sensors import AisPart, HullPart, LidarPart
from companion.core.readings import EscReading, HullReading, SonarReading
from companion.core.status_text import Severity, StatusText
from companion.hal.autopilot.parameters import RoverParameters
from companion.router.status import LinksStatus

pytest_plugins = ("doctor_fixtures",)

FITTED = BoatConfig(parts=Parts(hull=HullPart(driver="host")))


class Part:
    """Answers after some reads."""

    def __init__(self, reading: object, after: int = 0, texts: tuple[str, ...] = ()) -> None:
        self.reading, self.after, self.texts = reading, after, texts
        self.closed = 0

    def read(self) -> object:
        self.after -= 1
        return self.reading if self.after < 0 else None

    def take_texts(self) -> list[StatusText]:
        texts, self.texts = [StatusText(Severity.WARNING, text) for text in self.texts], ()
        return texts

    def close(self) -> None:
        self.closed += 1


def opening(part: LivePart) -> Callable[[BoatConfig, Callable[[], float]], LivePart]:
    return lambda config, now: part


def test_a_part_is_waited_for_and_closed() -> None:
    part = Part(HullReading(0.0, is_wet=False, temperature_c=41.2), after=20, texts=("set up again",))
    found = check_part("hull", opening(part), FITTED, FakeClock())
    assert (found.verdict, found.text) == (Verdict.FINE, "host: dry, 41 °C; set up again")
    assert part.closed == 1


def test_a_ranger_is_waited_for_until_it_has_looked_all_round() -> None:
    sweep = iter(([], [SonarReading(0.0, 0.0, None)], [SonarReading(0.1, math.pi / 6.0, 3.21)]))
    part = Part(None)
    part.read = lambda: next(sweep)  # type: ignore[method-assign]
    lidar = BoatConfig(parts=Parts(lidar=LidarPart(driver="ld06")))
    found = check_part("lidar", opening(part), lidar, FakeClock())
    assert found.text == "ld06: nearest echo 3.21 m 30° to starboard"


def test_no_part_with_readings_is_forgotten() -> None:
    fitted = {name for name in Parts.__struct_fields__ if hasattr(getattr(Parts(), name), "driver")}
    assert {*PARTS} == fitted - {"motors", "rudder"} | {"rc"}


def test_what_the_running_boat_misses_is_found(examine: Examine) -> None:
    why = "BNO055: no answer at I²C address 0x28"
    status = BoatStatus(4711, 0.1, 1, 0, 0, 0.0, LinksStatus(0.0, (), 0, 0, 0, 0), missing={"Compass": why})
    files = {"/run/mavboat/status.json": json.encode(status).decode(), "/proc/4711/comm": "boat-companion"}
    compass, others = part_findings(examine(files, FITTED), FakeClock())
    assert (compass.name, compass.verdict, compass.text) == ("Compass", Verdict.FAILED, why)
    assert (others.verdict, others.text) == (Verdict.SKIPPED, "the running boat uses the others")


# Motors


@pytest.fixture
def board(monkeypatch: pytest.MonkeyPatch) -> PinBoard:
    board = PinBoard()
    monkeypatch.setattr(gpiozero.Device, "pin_factory", board.factory)
    return board


BRIDGED = BoatConfig(parts=Parts(motors=MotorsPart(driver="l298n")))


def test_each_motor_turns_both_ways_after_a_typed_yes(board: PinBoard) -> None:
    said: list[str] = []
    found = nudge_motors(BRIDGED, FakeClock(), lambda question: "yes", said.append)
    assert found.verdict is Verdict.FINE
    assert said == [f"  {side} motor {way}" for side in ("left", "right") for way in ("ahead", "astern")]
    pins = BRIDGED.parts.motors
    legs = (pins.left_forward, pins.left_backward, pins.right_forward, pins.right_backward)
    assert [change.pin for change in board.history if change.pin in legs and change.value] == list(legs)
    assert max(change.value for change in board.history if change.pin not in legs) <= 0.5, "full drive"
    last = {change.pin: change.value for change in board.history}
    assert not any(last.values())


def test_an_ais_receiver_that_hears_no_ship_is_no_failure() -> None:
    config = BoatConfig(parts=Parts(ais=AisPart(driver="nmea")))
    found = check_part("ais", opening(Part(None)), config, FakeClock())
    assert (found.verdict, found.text) == (Verdict.WARNING, "nmea: no reading within 10 s")


def test_a_vesc_behind_another_is_waited_for_and_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    left = EscReading(0.0, 0, 1, 0.0, 15.2, 3.2, 41.0, 0.0)
    config = BoatConfig(parts=Parts(motors=MotorsPart(driver="vesc", can_id=11)))
    answers: Iterator[tuple[EscReading, ...]] = chain([(left,)], repeat((left, replace(left, side=1))))
    part = Part((left,))
    monkeypatch.setattr("companion.app.parts.open_esc", lambda *_, side: part)
    (found,) = check_escs(config, FakeClock())
    assert (found.name, found.verdict) == ("left ESC", Verdict.FAILED)
    assert found.text == "vesc: left 15.20 V, 3.20 A, 41 °C, and the right one does not answer over CAN"
    monkeypatch.setattr(part, "read", lambda: next(answers))
    (found,) = check_escs(config, FakeClock())
    assert (found.verdict, found.text.count("15.20 V")) == (Verdict.FINE, 2)


@pytest.mark.parametrize("answer", ["", "y", "Yes!", "no"])
def test_without_the_word_no_motor_turns(board: PinBoard, answer: str) -> None:
    found = nudge_motors(BRIDGED, FakeClock(), lambda question: answer, lambda _: None)
    assert found.verdict is Verdict.SKIPPED
    assert board.history == []


def test_speed_controllers_are_armed_before_they_turn(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    clock = FakeClock()
    kernel = plug_in_pwm(monkeypatch, tmp_path, PI_4, clock.now_s)
    escs = BoatConfig(parts=Parts(motors=MotorsPart(driver="esc")))
    assert nudge_motors(escs, clock, lambda question: "yes", lambda _: None).verdict is Verdict.FINE
    turned = [one for one in kernel.history if one.width_us not in (0.0, 1500.0)]
    assert turned[0].time_s >= escs.parts.motors.arming_s
    assert {one.output for one in turned} == {"pwmchip0/pwm0", "pwmchip0/pwm1"}
    assert (min(one.width_us for one in turned), max(one.width_us for one in turned)) == (1400.0, 1600.0)
    assert {one.output: one.width_us for one in kernel.history} == {
        "pwmchip0/pwm0": 0.0,
        "pwmchip0/pwm1": 0.0,
    }


def test_a_key_pressed_meanwhile_stops_the_motors(board: PinBoard) -> None:
    class Interrupted(FakeClock):
        def sleep(self, seconds: float) -> None:
            super().sleep(seconds)
            if self.time_s > 0.5:
                raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        nudge_motors(BRIDGED, Interrupted(), lambda question: "yes", lambda _: None)
    assert any(change.value for change in board.history)
    assert not any({change.pin: change.value for change in board.history}.values())


class AutopilotTwin:
    """A line whose parameters are read, or never are."""

    def __init__(self, values: dict[str, float]) -> None:
        self.fault, self.link, self.outputs = "autopilot is silent", self, self
        self.parameters = RoverParameters(255, has_rudder=False)
        self.parameters.values, self.parameters.is_complete = values, bool(values)

    def take_texts(self) -> list[StatusText]:
        return []

    def close(self) -> None:
        pass


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ({}, [(Verdict.FAILED, "autopilot is silent")]),
        (SET_UP, [(Verdict.FINE, "its parameters are as the boat needs them")]),
        (
            SET_UP | {"FS_THR_ENABLE": 0.0, "MOT_THR_MAX": 50.0},
            [
                (Verdict.FAILED, "FS_THR_ENABLE is 0, set it to 1"),
                (Verdict.WARNING, "MOT_THR_MAX is 50, set it to 100"),
            ],
        ),
    ],
)
def test_each_wrong_parameter_of_the_autopilot_is_named(
    values: dict[str, float], found: list[tuple[Verdict, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("companion.app.parts.behind_autopilot", lambda *_: AutopilotTwin(dict(values)))
    config = BoatConfig(parts=Parts(motors=MotorsPart(driver="autopilot")))
    assert [(one.verdict, one.text) for one in check_autopilot(config, FakeClock())] == found
    assert check_autopilot(BoatConfig(), FakeClock()) == []
