"""[[faults]] of a scenario: what is taken, and what is refused by name."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.errors import ConfigError
from sitl.scenarios.scenario import load_scenario
from sitl.world.faults.catalogue import CATALOGUE, FaultSetting

KINDS = [(what, kind) for what, kinds in CATALOGUE.items() for kind in kinds]


@given(st.sampled_from(KINDS), st.floats(-1e6, 1e6) | st.sampled_from([math.nan, math.inf, -math.inf]))
def test_a_size_is_taken_within_its_bounds_and_refused_outside(
    what_kind: tuple[str, str], size: float
) -> None:
    what, kind = what_kind
    effect = CATALOGUE[what][kind]
    if effect.low <= size <= effect.high and abs(size) <= 3.4e38:
        assert FaultSetting(what=what, kind=kind, size=size).amount == size
    else:
        with pytest.raises(ValueError, match="size"):
            FaultSetting(what=what, kind=kind, size=size)


@pytest.mark.parametrize(
    ("table", "named"),
    [
        ('{what="engine"}', "expected one of gnss"),
        ('{what="gnss", kind="deaf"}', "gnss can be corrupt"),
        ('{what="gnss", for_s=0}', "faults.0.for_s"),
        ('{what="gnss", at_s=-1}', "faults.0.at_s"),
        ('{what="motor_left", kind="weed", size=2}', "expected 0 to 1"),
        ('{what="gnss", colour="red"}', "no such setting"),
    ],
)
def test_a_fault_that_cannot_be_is_refused_with_its_place(table: str, named: str) -> None:
    with pytest.raises(ConfigError, match=r"faults\.0") as refused:
        load_scenario("open", [f"faults=[{table}]"])
    assert named in str(refused.value)


@pytest.mark.parametrize(
    ("what", "kind", "bounds"),
    [
        ("gnss", "slow", (1.0, math.inf)),
        ("sonar", "delayed", (0.0, 60.0)),
        ("rc", "intermittent", (0.04, math.inf)),
        ("battery", "corrupt", (0.0, 1.0)),
        ("gyro", "corrupt", (0.0, 1.0)),
        ("gyro", "garbage", (0.0, math.inf)),
        ("gnss", "garbage", (0.0, math.inf)),
        ("gnss", "jammed", (0.04, math.inf)),
        ("motor_left", "wrong", (-1.0, 1.0)),
        ("motor_left", "slow", (-1.0, 1.0)),
        ("motor_right", "stuck", (0.0, 1.0)),
        ("motor_right", "intermittent", (0.04, math.inf)),
        ("rc", "wrong", (500.0, 2500.0)),
        ("leak", "intermittent", (0.04, math.inf)),
        ("thermometer", "hot", (0.0, math.inf)),
        ("rudder", "wrong", (-45.0, 45.0)),
        ("link", "slow", (1.0, math.inf)),
        ("link", "delayed", (0.0, math.inf)),
        ("link", "intermittent", (0.04, math.inf)),
        ("link", "lossy", (0.0, 1.0)),
        ("cpu", "slow", (0.0, math.inf)),
        ("clock", "wrong", (0.0, math.inf)),
    ],
)
def test_no_size_is_taken_that_makes_no_sense(what: str, kind: str, bounds: tuple[float, float]) -> None:
    effect = CATALOGUE[what][kind]
    assert (effect.low, effect.high) == bounds
