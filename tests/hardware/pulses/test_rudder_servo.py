"""The rudder's servo over a twin of the kernel's PWM."""

import math

import pytest
from twins.lines import known
from twins.pulses import KernelPwm

from companion.app.composition import check_config
from companion.app.parts import open_rudder
from companion.config.boat_config import BoatConfig, decode_config
from companion.core.errors import ConfigError


def config(**tables: object) -> BoatConfig:
    return decode_config({"links": ["udpin:127.0.0.1:0"], **tables}, "test")


def test_a_positive_share_is_the_longer_pulse_and_zero_is_amidships(kernel: KernelPwm) -> None:
    signal = {"pin": 13, "min_us": 1000, "trim_us": 1480, "max_us": 2000}
    rudder = known(open_rudder(config(parts={"rudder": {"driver": "servo", "signal": signal}}), lambda: 0.0))
    for share in (0.5, -1.0, 2.0, math.nan):
        rudder.write(share)
    rudder.close()
    rudder.close()
    assert [one.width_us for one in kernel.history] == [1480.0, 1740.0, 1000.0, 2000.0, 1480.0, 0.0]


@pytest.mark.parametrize(
    ("layout", "driver"), [("rudder", "none"), ("differential_rudder", "none"), ("differential", "servo")]
)
def test_the_layout_and_the_part_must_agree(layout: str, driver: str) -> None:
    parts = {"motors": {"driver": "l298n"}, "rudder": {"driver": driver}}
    with pytest.raises(ConfigError, match=rf"parts\.rudder\.driver: drive.layout is '{layout}'"):
        check_config(config(drive={"layout": layout}, parts=parts))
