"""The calibration of speed controllers: what is sent, and that nothing is sent without the typed words."""

from collections.abc import Callable, Iterator

import pytest
from twins.pulses import KernelPwm

from companion.app.calibrate import CONFIRMATION, calibrate_escs
from companion.config.boat_config import BoatConfig, decode_config
from companion.hal.pulses.sysfs_pwm import open_sysfs_pulses

ESCS = {"parts": {"motors": {"driver": "esc"}}}
LEFT, RIGHT = "pwmchip0/pwm0", "pwmchip0/pwm1"


def answers(*texts: str) -> Callable[[str], str]:
    rest: Iterator[str] = iter(texts)

    def ask(_: str) -> str:
        text = next(rest, None)
        if text is None:
            raise KeyboardInterrupt
        return text

    return ask


def config(**tables: object) -> BoatConfig:
    return decode_config({**ESCS, **tables}, "test")


def run(kernel: KernelPwm, tree: BoatConfig, *texts: str) -> list[tuple[str, float]]:
    assert calibrate_escs(tree, open_sysfs_pulses, answers(*texts), lambda _: None)
    return [(signal.output, signal.width_us) for signal in kernel.history]


def test_each_chosen_pulse_is_sent_to_both_and_neutral_before_the_end(kernel: KernelPwm) -> None:
    sent = run(kernel, config(), CONFIRMATION, "high", "low", "full", "NEUTRAL ", "low", "end")
    for side in (LEFT, RIGHT):
        widths = [width_us for output, width_us in sent if output == side]
        assert widths == [1900.0, 1100.0, 1500.0, 1100.0, 1500.0, 0.0]


@pytest.mark.parametrize("typed", ["", "yes", "propellers on"])
def test_nothing_is_opened_or_sent_without_the_words(kernel: KernelPwm, typed: str) -> None:
    assert not calibrate_escs(config(), open_sysfs_pulses, answers(typed, "high"), lambda _: None)
    assert kernel.history == []


def test_ctrl_c_at_full_throttle_sends_neutral_and_ends_the_pulses(kernel: KernelPwm) -> None:
    waits: list[float] = []
    with pytest.raises(KeyboardInterrupt):
        calibrate_escs(config(), open_sysfs_pulses, answers(CONFIRMATION, "high"), waits.append)
    assert [signal.width_us for signal in kernel.history if signal.output == LEFT] == [1900.0, 1500.0, 0.0]
    assert len(waits) == 1
    assert waits[0] >= 0.06
