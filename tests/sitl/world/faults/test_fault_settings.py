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
