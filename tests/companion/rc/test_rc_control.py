"""A transmitter and its receiver: sticks, switches, arming, and what is done when it is lost."""

import pytest
from boat_rig import FRAME, GOOD_FIX, nav_at
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig, with_value
from companion.config.tuning import RcChannel
from companion.core.intent import Drive, Intent, Stop
from companion.core.modes import Mode
from companion.core.readings import RcReading
from companion.core.requests import Arm, ChangeMode, Disarm, ManualControl
from companion.core.status_text import Severity
from companion.rc.pulses import LOW, deflection, mode_position, pulse_of
from companion.rc.rc_control import RcControl
from companion.rc.switches import SETTLE_S, Switch
from companion.vehicle.vehicle import Vehicle

STEERING, THROTTLE, ARM, MODE = 0, 2, 4, 5
MANUAL_US, HOLD_US, LOITER_US, AUTO_US = 1100, 1300, 1425, 1550  # MODE1, 2, 3, 4
STEP_S = 0.02


class Hand:
    """A boat at rest with a receiver, and the transmitter's channels."""

    def __init__(self, **settings: object) -> None:
        config = BoatConfig()
        for name, value in {"rc__arm_channel": 5, "rc__mode_channel": 6, **settings}.items():
            config = with_value(config, name.replace("__", "."), value)
        self.vehicle = Vehicle(config)
        self.rc_control = RcControl()
        self.channels = [1500, 1500, 1500, 1500, 1000, MANUAL_US, 1500, 1500]
        self.now_s = 0.0
        self.is_on = True
        self.is_failsafe = False
        self.intent: Intent = Stop()

    def live(self, seconds: float, **moves: int) -> list[str]:
        """Move the sticks, and let time go by; what was told."""
        for name, pulse_us in moves.items():
            self.channels[{"steering": STEERING, "throttle": THROTTLE, "arm": ARM, "mode": MODE}[name]] = (
                pulse_us
            )
        for _ in range(round(seconds / STEP_S)):
            self.now_s += STEP_S
            self.vehicle.update_state(nav_at(time_s=self.now_s), FRAME, GOOD_FIX, None, self.now_s)
            if self.is_on:
                reading = RcReading(self.now_s, tuple(self.channels), self.is_failsafe)
                actions = self.rc_control.update(
                    reading,
                    self.vehicle.manual_input,
                    self.vehicle.mode,
                    self.vehicle.armed,
                    self.vehicle.config,
                    self.now_s,
                )
                if actions.text:
                    self.vehicle.notify(Severity.NOTICE, actions.text)
                for request in actions.requests:
                    self.vehicle.request(request)
            self.intent = self.vehicle.decide()
        return [notice.text for notice in self.vehicle.take_status_texts()]

    @property
    def drive(self) -> tuple[float, float]:
        """Throttle and steering of a boat that is driven by hand."""
        assert isinstance(self.intent, Drive)
        return self.intent.throttle, self.intent.steering

    def armed(self) -> "Hand":
        """Switched on in MANUAL and armed by the switch."""
        self.live(0.5)
        self.live(0.5, arm=2000)
        assert self.vehicle.armed
        return self


# Sticks


@given(
    pulse_us=st.integers(-1000, 5000),
    low=st.integers(800, 2200),
    trim=st.integers(800, 2200),
    high=st.integers(800, 2200),
    dead=st.integers(0, 200),
)
def test_no_calibration_however_odd_makes_more_than_full_deflection(
    pulse_us: int, low: int, trim: int, high: int, dead: int
) -> None:
    channel = RcChannel(min_us=low, trim_us=trim, max_us=high, dead_us=dead)
    assert -1.0 <= deflection(pulse_us, channel, dead) <= 1.0


@pytest.mark.parametrize("channel", [RcChannel(1100, 1520, 1900), RcChannel(1000, 1500, 2000, 30, True)])
@pytest.mark.parametrize("pulse_us", [1100, 1400, 1520, 1899])
def test_a_pulse_follows_from_its_deflection(channel: RcChannel, pulse_us: int) -> None:
    assert pulse_of(deflection(pulse_us, channel, 0), channel) == pulse_us


def test_a_stick_that_moves_is_urgent_once_and_one_that_rests_is_not() -> None:
    hand = Hand().armed()
    sticks, config = hand.vehicle.manual_input, hand.vehicle.config

    def frame(throttle: int) -> bool:
        hand.now_s += STEP_S
        hand.channels[THROTTLE] = throttle
        reading = RcReading(hand.now_s, tuple(hand.channels))
        vehicle = hand.vehicle
        actions = hand.rc_control.update(reading, sticks, vehicle.mode, vehicle.armed, config, hand.now_s)
        return actions.is_urgent

    assert [frame(throttle) for throttle in (1500, 1800, 1800, 1803, 1806)] == [
        False,
        True,
        False,
        False,
        True,
    ]


def test_the_sticks_may_lie_on_other_channels_and_the_other_way_round() -> None:
    hand = Hand(rc__steering_channel=3, rc__throttle_channel=1, rc__channel_3__is_reversed=True).armed()
    hand.live(0.1, throttle=2000)
    assert hand.drive == (0.0, -1.0)


# Arming


def test_the_switch_arms_when_it_goes_up_and_disarms_when_it_goes_down() -> None:
    hand = Hand()
    assert hand.live(0.5) == ["Mode MANUAL: mode switch"]
    assert hand.live(0.5, arm=2000) == ["Armed"]
    assert hand.live(0.5, arm=1500) == []
    assert hand.live(0.5, arm=1000) == ["Disarmed by the arming switch"]


def test_a_switch_that_went_up_while_the_transmitter_was_lost_does_not_arm() -> None:
    hand = Hand()
    hand.live(0.5)
    hand.is_on = False
    hand.live(2.0, arm=2000)
    hand.is_on = True
    hand.live(5.0)
    assert not hand.vehicle.armed
    hand.live(0.5, arm=1000)
    hand.live(0.5, arm=2000)
    assert hand.vehicle.armed


def test_a_switch_that_went_down_while_the_transmitter_was_lost_disarms() -> None:
    hand = Hand().armed()
    hand.is_on = False
    hand.live(0.8, arm=1000)
    assert hand.vehicle.armed
    hand.is_on = True
    assert "Disarmed by the arming switch" in hand.live(0.5)


@pytest.mark.parametrize("stick", ["throttle", "steering"])
@pytest.mark.parametrize("pulse_us", [1469, 1531])
def test_the_boat_does_not_arm_while_a_stick_is_not_neutral(stick: str, pulse_us: int) -> None:
    hand = Hand()
    hand.live(0.5, **{stick: pulse_us})
    why = f"RC: {stick} (RC{3 if stick == 'throttle' else 1}) is not neutral"
    assert hand.live(0.5, arm=2000) == [f"Arm: {why}"]
    assert hand.vehicle.request(Arm()).reason == why
    assert hand.vehicle.request(Arm(force=True)).accepted


def test_a_station_that_steers_answers_for_the_sticks_in_place_of_the_transmitter() -> None:
    hand = Hand()
    hand.live(0.5, throttle=2000)
    hand.vehicle.request(ManualControl(0.0, 0.0))
    assert hand.vehicle.request(Arm()).accepted
    hand.vehicle.request(Disarm())
    hand.live(0.5, throttle=1500)
    hand.vehicle.request(ManualControl(None, -0.061))
    assert hand.vehicle.request(Arm()).reason == "RC: steering (RC1) is not neutral"
    hand.vehicle.request(ManualControl(None, -0.059))
    assert hand.vehicle.request(Arm()).accepted


def test_a_station_does_not_arm_a_boat_whose_transmitter_was_lost() -> None:
    hand = Hand()
    hand.live(0.5)
    hand.is_on = False
    hand.live(1.0)
    assert hand.vehicle.request(Arm()).reason == "RC: the receiver is silent"
    hand.vehicle.config = with_value(hand.vehicle.config, "failsafe.rc_enabled", 0)
    assert hand.vehicle.request(Arm()).accepted


def test_an_arming_switch_that_is_put_on_a_channel_that_is_up_does_not_arm() -> None:
    hand = Hand()
    hand.channels[7] = 2000
    hand.live(1.0)
    hand.vehicle.config = with_value(hand.vehicle.config, "rc.arm_channel", 8)
    hand.live(1.0)
    hand.channels[7] = 1500
    hand.live(1.0)
    hand.channels[7] = 2000
    hand.live(1.0)
    assert not hand.vehicle.armed


def test_a_switch_whose_channel_changes_is_read_anew() -> None:
    switch = Switch()
    for now_s in (0.0, SETTLE_S):
        assert switch.pulse_us((1000, 1000), 1) == 1000
        moved = switch.update(LOW, now_s)
    assert moved
    assert switch.pulse_us((1000, 1000), 2) == 1000
    assert not switch.update(LOW, 2 * SETTLE_S)  # seen there for no time yet
    assert not switch.is_steady
    assert switch.update(LOW, 3 * SETTLE_S)


# The mode switch


@pytest.mark.parametrize(
    ("pulse_us", "position"),
    [
        *[(900, 0), (1230, 0), (1231, 1), (1360, 1), (1361, 2), (1490, 2)],
        *[(1491, 3), (1620, 3), (1621, 4), (1749, 4), (1750, 5), (2100, 5)],
    ],
)
def test_the_six_bands_of_the_mode_switch(pulse_us: int, position: int) -> None:
    assert mode_position(pulse_us) == position


def test_each_position_has_its_mode() -> None:
    hand = Hand(rc__mode_2=11).armed()
    assert hand.live(0.5, mode=LOITER_US) == ["Mode LOITER"]
    assert "Mode RTL" in hand.live(0.5, mode=HOLD_US)
    assert hand.live(0.5, mode=AUTO_US) == ["AUTO: no mission"]
    assert hand.vehicle.mode is Mode.RTL


def test_a_boat_that_is_under_way_does_not_change_its_mode_when_a_transmitter_is_switched_on() -> None:
    hand = Hand()
    hand.is_on = False
    hand.live(0.5)
    hand.vehicle.request(ChangeMode(Mode.LOITER))
    hand.vehicle.request(Arm())
    hand.is_on = True
    hand.live(2.0)
    assert hand.vehicle.mode is Mode.LOITER
    hand.live(0.5, mode=HOLD_US)
    assert hand.vehicle.mode.name == "HOLD"


# Stations beside it


def test_a_stations_sticks_go_first_while_they_are_fresh() -> None:
    hand = Hand().armed()
    hand.live(0.5, throttle=2000)
    hand.vehicle.request(ManualControl(-0.5, 0.25))
    told = hand.live(0.5)
    assert hand.drive == (-0.5, 0.25)
    assert told == ["Helm: a station's sticks have priority"]
    assert hand.live(1.0) == ["Helm: the transmitter's again"]
    assert hand.drive == (1.0, 0.0)


def test_sticks_of_a_station_are_lost_when_all_are_stale_until_they_are_let_go() -> None:
    hand = Hand()
    hand.is_on = False
    sticks, config = hand.vehicle.manual_input, hand.vehicle.config
    assert not sticks.is_lost(config, 0.0)
    sticks.ingest(ManualControl(0.5, 0.0), 0.0)
    assert not sticks.is_lost(config, config.failsafe.manual_timeout_s)
    assert sticks.is_lost(config, config.failsafe.manual_timeout_s + 0.1)
    sticks.ingest(ManualControl(0.5, 0.0), 5.0)
    sticks.invalidate()
    assert sticks.is_lost(config, 5.0)
    sticks.release()
    assert not sticks.is_lost(config, 9.0)


def test_a_station_moves_the_transmitters_switches_and_gives_them_back() -> None:
    hand = Hand()
    hand.live(0.5, mode=HOLD_US)

    def override(seconds: float, arm: int, mode: int) -> list[str]:
        texts: list[str] = []
        for _ in range(round(seconds / 0.1)):
            hand.vehicle.manual_input.override({5: arm, 6: mode}, hand.now_s)
            texts += hand.live(0.1)
        return texts

    assert override(0.5, 1000, MANUAL_US) == ["Mode MANUAL"]
    assert override(0.5, 2000, MANUAL_US) == ["Armed"]
    assert hand.live(2.0) == ["Disarmed by the arming switch", "Mode HOLD"]
    override(2.0, 2000, HOLD_US)  # has not been seen down since the station took it
    assert not hand.vehicle.armed


# The transmitter is lost


def test_the_motors_stop_at_once_and_the_boat_keeps_station_after_that() -> None:
    hand = Hand().armed()
    hand.live(1.0, throttle=2000)
    hand.is_on = False
    assert hand.live(0.48) == []
    assert hand.drive == (1.0, 0.0)
    hand.live(0.1)
    assert isinstance(hand.intent, Stop)
    assert hand.live(1.7) == ["Failsafe: RC lost: the receiver is silent", "Mode LOITER: failsafe"]
    assert "Mode RTL: failsafe" in hand.live(125.0)


def test_pulses_that_are_set_for_the_failsafe_count_as_lost_and_move_no_switch() -> None:
    hand = Hand().armed()
    told = hand.live(2.2, throttle=900, mode=HOLD_US, arm=1000)
    assert told == ["Failsafe: RC lost: throttle below FS_THR_VALUE", "Mode LOITER: failsafe"]
    assert hand.vehicle.armed


def test_channels_that_leap_about_count_as_lost() -> None:
    hand = Hand().armed()
    told: list[str] = []
    for number in range(150):
        hand.channels = [1000 + 137 * (number * number + 5 * place) % 1000 for place in range(8)]
        told += hand.live(STEP_S)
    assert "Failsafe: RC lost: the receiver talks nonsense" in told
    assert hand.vehicle.mode.name == "LOITER"
    assert hand.vehicle.armed


@given(st.lists(st.lists(st.integers(-100, 5000), max_size=18), max_size=40))
def test_random_frames_neither_arm_nor_break_the_boat(frames: list[list[int]]) -> None:
    hand = Hand()
    for channels in frames:
        hand.channels = channels
        hand.live(STEP_S)
    assert not hand.vehicle.armed
