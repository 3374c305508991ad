"""The numbers of sticks, switches and channels: what is just within a limit, and what is just beyond it."""

import pytest

from companion.config.boat_config import BoatConfig, with_value
from companion.config.tuning import Rc, RcChannel
from companion.core.modes import Mode
from companion.core.readings import RcReading
from companion.core.requests import Arm, ChangeMode, Disarm, ManualControl
from companion.rc.manual_input import ManualInput, top_speed_m_s
from companion.rc.parsers import PAUSE_S, SbusParser
from companion.rc.pulses import (
    HIGH,
    LOW,
    MIDDLE,
    deflection,
    is_override,
    is_pulse,
    pulse_of,
    switch_position,
)
from companion.rc.rc_control import RcActions, RcControl
from companion.rc.rc_input import RcInput, RcNoise
from companion.rc.switches import SETTLE_S, Switches

CONFIG = BoatConfig()
UP, DOWN, HOLD_US = 2000, 1000, 1300


@pytest.mark.parametrize(("pulse_us", "is_valid"), [(799, False), (800, True), (2200, True), (2201, False)])
def test_a_receivers_pulse_is_valid_from_800_to_2200_microseconds(pulse_us: int, is_valid: bool) -> None:
    assert is_pulse(pulse_us) is is_valid


@pytest.mark.parametrize(("pulse_us", "is_valid"), [(899, False), (900, True), (2100, True), (2101, False)])
def test_an_overrides_pulse_is_valid_from_900_to_2100_microseconds(pulse_us: int, is_valid: bool) -> None:
    assert is_override(pulse_us) is is_valid


@pytest.mark.parametrize(
    ("pulse_us", "position"), [(1199, LOW), (1200, MIDDLE), (1800, MIDDLE), (1801, HIGH)]
)
def test_the_bands_of_a_switch_are_rovers(pulse_us: int, position: int) -> None:
    assert switch_position(pulse_us) == position
    assert len({LOW, MIDDLE, HIGH}) == 3


@pytest.mark.parametrize(
    ("pulse_us", "dead_us", "expected"),
    [(1501, 0, 1 / 400), (1499, 0, -1 / 500), (1530, 30, 0.0), (1531, 30, 1 / 370), (1469, 30, -1 / 470),
     (2100, 30, 1.0), (900, 30, -1.0)],
)  # fmt: skip
def test_a_deflection_begins_with_the_first_microsecond_beyond_the_dead_zone(
    pulse_us: int, dead_us: int, expected: float
) -> None:
    assert deflection(pulse_us, RcChannel(min_us=1000, trim_us=1500, max_us=1900), dead_us) == pytest.approx(
        expected
    )


@pytest.mark.parametrize(("share", "pulse_us"), [(0.5, 1500), (0.001, 1001), (-0.5, 1000)])
def test_a_throttle_without_reverse_has_no_pulse_astern(share: float, pulse_us: int) -> None:
    assert pulse_of(share, RcChannel(min_us=1000, trim_us=1000, max_us=2000)) == pulse_us


@pytest.mark.parametrize(("cruise_throttle", "top_m_s"), [(0.5, 4.0), (0.07, 2.0 / 0.07), (0.01, 40.0)])
def test_the_top_speed_follows_from_a_cruise_throttle_that_was_measured(
    cruise_throttle: float, top_m_s: float
) -> None:
    setting = with_value(
        with_value(CONFIG, "speed.cruise_throttle", cruise_throttle), "speed.max_throttle", 1.0
    )
    assert top_speed_m_s(with_value(setting, "speed.cruise_m_s", 2.0).speed) == pytest.approx(top_m_s)


def test_sticks_that_do_not_steer_are_no_fault_when_they_are_stale() -> None:
    sticks = ManualInput()
    assert sticks.latest == ManualControl(0.0, 0.0)
    sticks.ingest(ManualControl(0.5, 0.0), 0.0)
    sticks.stop_watching()
    assert not sticks.is_lost(CONFIG, 60.0)


def test_channels_are_filled_up_to_the_highest_that_a_station_holds() -> None:
    sticks = ManualInput()
    assert sticks.channels_us(CONFIG, 0.0) == ()
    sticks.override({6: 1700}, 0.0)
    sticks.ingest(ManualControl(0.5, None), 0.0)
    assert sticks.channels_us(CONFIG, 0.0) == (0, 0, 1750, 0, 0, 1700)
    sticks.rc.ingest(RcReading(0.0, (1500,) * 8), CONFIG.rc)
    assert sticks.channels_us(CONFIG, 0.0) == (1500, 1500, 1750, 1500, 1500, 1700, 1500, 1500)
    sticks.invalidate()
    assert sticks.channels_us(CONFIG, 0.0) == (1500,) * 8
    assert sticks.overridden(CONFIG, 0.0) == {}


@pytest.mark.parametrize("stick", [1, 3])
def test_a_stick_without_a_pulse_spoils_the_frame_and_another_channel_does_not(stick: int) -> None:
    radio, channels = RcInput(), [1500] * 4
    channels[1] = channels[3] = 2500
    assert radio.ingest(RcReading(0.0, tuple(channels)), CONFIG.rc)
    assert radio.fault(CONFIG.rc, 0.0) == ""
    channels[stick - 1] = 2500
    assert not radio.ingest(RcReading(0.1, tuple(channels)), CONFIG.rc)
    assert radio.fault(CONFIG.rc, 9.0) == "no pulse on a stick's channel"


@pytest.mark.parametrize(("moved", "leaps"), [(0, False), (4, False), (5, True), (8, True)])
def test_a_frame_leaps_when_most_of_its_channels_do(moved: int, leaps: bool) -> None:
    noise = RcNoise()
    noise.update((1000,) * 8)
    noise.update((1251,) * moved + (1250,) * (8 - moved))
    assert noise.leaps is leaps


def test_a_movement_of_a_switch_and_of_nothing_else_cannot_wait() -> None:
    control, sticks = RcControl(), ManualInput()
    config = with_value(CONFIG, "rc.mode_channel", 6)
    actions = []
    for tick in range(30):
        now_s = 0.02 * tick
        sticks.override({6: HOLD_US}, now_s)
        reading = RcReading(now_s, (1500,) * 4)
        actions.append(control.update(reading, sticks, Mode.MANUAL, armed=False, config=config, now_s=now_s))
    assert [one for one in actions if one != RcActions()] == [
        RcActions((ChangeMode(Mode.HOLD, is_initial=True),), "", is_urgent=True)
    ]
    assert not RcActions().is_urgent


def test_a_first_mode_is_obeyed_with_a_disarming_and_not_with_an_arming() -> None:
    for before_us, after_us, is_armed, expected in (
        (DOWN, UP, False, (Arm(),)),
        (UP, DOWN, True, (Disarm("by the arming switch"), ChangeMode(Mode.HOLD, is_initial=True))),
    ):
        switches = Switches()
        for now_s in (0.0, SETTLE_S):
            assert switches.update((before_us, HOLD_US), is_armed, Rc(arm_channel=1), now_s) == ()
        both = Rc(arm_channel=1, mode_channel=2)
        assert switches.update((after_us, HOLD_US), is_armed, both, 1.0) == ()
        assert switches.update((after_us, HOLD_US), is_armed, both, 1.1 + SETTLE_S) == expected


def test_bytes_before_the_first_pause_of_an_sbus_line_are_counted() -> None:
    parser = SbusParser()
    parser.feed(b"", 0.0)
    assert parser.feed(b"\x0f\x00", PAUSE_S / 2.0) is None
    assert parser.skipped == 2


def seen_down() -> Switches:
    switches = Switches()
    for now_s in (0.0, 2.0 * SETTLE_S):
        assert switches.update((DOWN,), False, Rc(arm_channel=1), now_s) == ()
    return switches


def test_after_a_silence_a_glimpse_of_the_switch_down_does_not_let_it_arm() -> None:
    switches = seen_down()
    switches.forget_positions()
    assert switches.update((DOWN,), False, Rc(arm_channel=1), 1.0) == ()
    for step in range(1, 20):
        assert switches.update((UP,), False, Rc(arm_channel=1), 1.0 + step * SETTLE_S) == ()
