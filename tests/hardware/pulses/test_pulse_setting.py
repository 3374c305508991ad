"""The configuration of a servo signal, and the share of travel that a width stands for."""

import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.actuators import PulseOutputSetting


@pytest.mark.parametrize(
    ("share", "width_us"),
    [(-1.0, 1000.0), (-0.5, 1225.0), (0.0, 1450.0), (0.5, 1675.0), (1.0, 1900.0), (7.0, 1900.0)],
)
def test_each_side_of_the_trim_has_its_own_scale(share: float, width_us: float) -> None:
    setting = PulseOutputSetting(min_us=1000, trim_us=1450, max_us=1900)
    assert setting.width_us(share) == pytest.approx(width_us)
    turned = msgspec.structs.replace(setting, reversed=True)
    assert turned.width_us(-share) == pytest.approx(width_us)


@given(st.floats())
def test_no_share_and_no_width_leaves_the_range(value: float) -> None:
    setting = PulseOutputSetting(min_us=1200, trim_us=1480, max_us=1700)
    for width_us in (setting.width_us(value), setting.limited_us(value)):
        assert 1200.0 <= width_us <= 1700.0
        if not math.isfinite(value):
            assert width_us == 1480.0


@pytest.mark.parametrize(
    "table",
    [
        {"min_us": 1600},
        {"min_us": 1500, "max_us": 1500},
        {"frequency_hz": 400, "max_us": 2500},
        {"frequency_hz": 401},
        {"max_us": 2501},
        {"channel": 16},
    ],
)
def test_widths_out_of_order_or_range_are_refused(table: dict[str, int]) -> None:
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert(table, PulseOutputSetting)
