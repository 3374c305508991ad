"""The arming switch after a silence."""

from companion.config.tuning import Rc
from companion.core.requests import Arm
from companion.rc.switches import SETTLE_S, Switches

DOWN, UP = (1000,), (2000,)
SETTING = Rc(arm_channel=1)


def seen_down() -> Switches:
    switches = Switches()
    for now_s in (0.0, 2.0 * SETTLE_S):
        assert switches.update(DOWN, False, SETTING, now_s) == ()
    return switches


def test_a_switch_seen_down_arms_when_it_goes_up() -> None:
    switches = seen_down()
    assert switches.update(UP, False, SETTING, 1.0) == ()
    assert switches.update(UP, False, SETTING, 1.0 + 2.0 * SETTLE_S) == (Arm(),)


def test_after_a_silence_a_glimpse_of_the_switch_down_does_not_let_it_arm() -> None:
    switches = seen_down()
    switches.forget_positions()
    assert switches.update(DOWN, False, SETTING, 1.0) == ()
    for step in range(1, 20):
        assert switches.update(UP, False, SETTING, 1.0 + step * SETTLE_S) == ()
