"""The reasons: every text of the boat has words for people, and the page shows those that hold now."""

import inspect
import re

import pytest
from boat_rig import FakeBattery, Rig
from shore_rig import Shore

import companion.vehicle.arming
from companion.core.state import FAULT_TEXTS
from companion.failsafe import conditions
from companion.failsafe.motors import rudder_watch
from companion.failsafe.motors.hypotheses import HYPOTHESES
from companion.failsafe.table import ROWS
from companion.persistence.mission_store import DataLosses
from mission_tools.station.messages import Battery
from mission_tools.station.reasons import Reasons, words, words_for
from mission_tools.station.texts import Text
from mission_tools.station.view import View

# What the conditions take from elsewhere than their own literals
TEXTS_ELSEWHERE = [
    "Point of no return: 900 mAh, 910 needed",
    *(hypothesis.text for hypothesis in HYPOTHESES),
    *(text for _, text in FAULT_TEXTS),
]


def texts_in(thing: object) -> list[str]:
    """The beginnings of the boat's texts in a piece of its source: literals that start like a sentence."""
    found = re.findall(r'(?:return|fault =|if \w+ else|append\() ?f?"([A-Z][^"{]*)', inspect.getsource(thing))  # type: ignore[arg-type]
    return [text for text in found if text.strip() != "Battery"]  # which goes on with a value


@pytest.mark.parametrize(
    "text",
    [
        *texts_in(companion.vehicle.arming.fence_faults),
        *texts_in(companion.vehicle.arming.sensor_faults),
        *texts_in(companion.vehicle.arming.rc_fault),
        "Motors: L298N: the pins cannot be opened",
        companion.vehicle.arming.RESTARTING,
        "Compass: not calibrated: start its calibration and turn the boat",
        "Compass: field of 3 mG, not 190: iron near, or calibrate again",
        "RC: the receiver is silent",
    ],
)
def test_every_arming_fault_has_words(text: str) -> None:
    found = words_for(text)
    assert found is not None
    assert found.why
    assert found.next
    assert not found.over


@pytest.mark.parametrize(
    "text",
    [
        *texts_in(conditions),
        *(f"Battery {what}: 9.0 V" for what in ("low", "critical")),
        *texts_in(rudder_watch),
        "Left motor gives no thrust",
        "Right motor gives no thrust",
        *TEXTS_ELSEWHERE,
    ],
)
def test_every_failsafe_has_words(text: str) -> None:
    found = words_for(text)
    assert found is not None, text
    assert found.why
    assert found.next


def test_every_end_of_a_failsafe_ends_its_reason() -> None:
    ends = {entry.over for entry in words().values()}
    assert {row.over for row in ROWS} <= ends
    assert ends <= {row.over for row in ROWS}


def test_a_failsafe_is_a_reason_until_it_is_over() -> None:
    reasons = Reasons()
    reasons.on_text(Text(2, "Failsafe: Water in the hull"), 1.0)
    reasons.on_text(Text(2, "Failsafe: Stuck: something holds the boat"), 2.0)
    reasons.on_text(Text(2, "Failsafe: Stuck: something holds the boat (persists)"), 3.0)
    assert [one.text for one in reasons.now()] == ["Water in the hull", "Stuck: something holds the boat"]
    reasons.on_text(Text(5, "Failsafe over: hull dry again"), 4.0)
    assert [one.text for one in reasons.now()] == ["Stuck: something holds the boat"]


def test_a_low_battery_is_a_reason_until_the_boat_has_another() -> None:
    reasons, view = Reasons(), View()
    reasons.on_text(Text(2, "Failsafe: Battery low: 10.1 V"), 1.0)
    view.battery_is_well = False
    reasons.poll(view, 2.0)
    assert len(reasons.now()) == 1
    view.battery_is_well = True
    reasons.poll(view, 3.0)
    assert reasons.now() == []


@pytest.mark.parametrize("name", ["mission", "fence", "rally", "parameters", "voyage record",
                                  "track of SMART_RTL", "signing key", "signing timestamps"])  # fmt: skip
def test_every_lost_list_has_words(name: str) -> None:
    losses = DataLosses()
    losses.add(name, "it is damaged", "Do something")
    found = words_for(losses.text(name))
    assert found is not None
    assert found.stands


def test_a_text_that_the_boat_repeats_is_a_reason_while_it_does() -> None:
    reasons, view = Reasons(), View()
    for at_s in (0.0, 30.0):
        reasons.on_text(Text(4, "Power lost at item 3, 41 m along: arm and MISSION_START to resume"), at_s)
        reasons.poll(view, at_s + 29.0)
        assert [one.next for one in reasons.now()] == ["Arm it and start the mission to go on."]
    reasons.poll(view, 71.0)
    assert reasons.now() == []


def test_a_failsafe_that_fired_before_the_boat_was_heard_shows_in_its_status() -> None:
    reasons, view = Reasons(), View()
    view.armed, view.is_outside, view.battery_is_well = True, True, False
    view.battery = Battery(voltage_v=9.9)
    reasons.poll(view, 1.0)
    assert [one.text for one in reasons.now()] == ["Outside the fence", "Battery low"]
    reasons.on_text(Text(2, "Failsafe: Battery critical: 9.5 V"), 2.0)
    assert [one.text for one in reasons.now()] == ["Battery critical: 9.5 V", "Outside the fence"]
    view.battery = Battery(voltage_v=None)  # a silent monitor says nothing about the pack
    assert [one.text for one in reasons.now()] == ["Battery critical: 9.5 V", "Outside the fence"]
    view.armed = False
    reasons.poll(view, 3.0)
    assert [one.text for one in reasons.now()] == ["Battery critical: 9.5 V"]


def test_a_flood_of_reasons_is_bounded() -> None:
    reasons = Reasons()
    for number in range(1000):
        reasons.on_text(Text(2, f"Failsafe: {number}"), 1.0)
        reasons.on_text(Text(2, f"PreArm: {number}"), 1.0)
    assert len(reasons.now()) <= 40


def test_the_reason_is_gone_when_the_boat_may_arm() -> None:
    battery = FakeBattery(10.0)
    rig = Rig(battery=battery)
    shore = Shore(rig)
    shore.until(lambda: bool(shore.boats.names()) and bool(shore.snapshot().reasons), 20.0)
    assert any(one.text.startswith("Battery:") for one in shore.snapshot().reasons)
    battery.voltage_v = 12.6
    shore.until(lambda: not shore.snapshot().reasons, 5.0)


def test_the_boat_is_asked_for_its_reasons_soon_and_then_rarely_as_every_station_hears_them() -> None:
    reasons, view, asked_s = Reasons(), View(), []
    view.may_arm, view.armed, view.mode = False, False, "HOLD"
    for now_s in range(80):
        view.mode = "HOLD" if now_s < 70 else "AUTO"
        if reasons.poll(view, now_s):
            asked_s.append(now_s)
            reasons.on_text(Text(2, "PreArm: Compass: no heading"), now_s)
    assert asked_s == [0, 30, 60, 70]
    view.may_arm = True
    assert not reasons.poll(view, 80.0)
    assert reasons.now() == []


def test_a_new_report_replaces_the_one_before() -> None:
    reasons = Reasons()
    reasons.on_text(Text(2, "PreArm: GPS: no 3-D fix"), 0.0)
    reasons.on_text(Text(2, "PreArm: Compass: no heading"), 0.1)
    assert len(reasons.now()) == 2
    reasons.on_text(Text(2, "PreArm: Compass: no heading"), 30.0)
    assert [one.text for one in reasons.now()] == ["Compass: no heading"]
