"""Single readings that are impossible are rejected, and real changes are not locked out."""

import math
import random
from typing import Any

import msgspec
import pytest
from twins.lines import known

from companion.core.geo import LatLon
from companion.core.readings import BatteryReading, DepthReading, GnssFix, HeadingReading
from companion.sensors.plausibility import BATTERY, DEPTH, FIX, HEADING, Limit, ReadingGate, ValueGate

DT_S = 0.02
LIMIT = Limit(-2.0, 2.0, 0.2, 3.0)  # 0.26 a reading


def calm(limit: Limit = LIMIT, value: float = 0.0) -> tuple[ValueGate, float]:
    """A gate after a second of equal readings, and the time of the next one."""
    gate = ValueGate(limit)
    for tick in range(50):
        assert gate.accepts(value, DT_S * tick)
    return gate, 50 * DT_S


def accepted(gate: ValueGate, since_s: float, *values: float) -> list[bool]:
    return [gate.accepts(value, since_s + DT_S * tick) for tick, value in enumerate(values)]


@pytest.mark.parametrize("value", [0.27, -0.27, 1.9, 2.1, math.nan, math.inf])
def test_one_impossible_reading_is_rejected_and_the_next_good_one_is_accepted(value: float) -> None:
    gate, now_s = calm()
    assert accepted(gate, now_s, value, 0.0, 0.25) == [False, True, True]


def test_a_real_change_is_accepted_with_the_third_reading_that_agrees() -> None:
    gate, now_s = calm()
    assert accepted(gate, now_s, 1.0, 1.1, 1.2, 1.3) == [False, False, True, True]


def test_a_first_reading_that_is_wrong_locks_no_good_one_out() -> None:
    gate = ValueGate(LIMIT)
    assert accepted(gate, 0.0, 1.9, 0.0, 0.0, 0.0, 0.0) == [True, False, False, True, True]


def test_what_changes_over_a_silence_is_allowed_for() -> None:
    gate, now_s = calm()
    assert gate.accepts(1.5, now_s + 0.5)


def test_an_angle_may_wrap() -> None:
    gate, now_s = calm(Limit(-4.0, 4.0, 0.2, 3.0, is_angle=True), math.pi - 0.01)
    assert accepted(gate, now_s, -math.pi + 0.01) == [True]


def test_a_part_that_talks_nonsense_has_no_value_until_it_has_agreed_with_itself_for_15_readings() -> None:
    gate, now_s = calm()
    numbers = random.Random(5)
    nonsense = accepted(gate, now_s, *[numbers.uniform(-2.0, 2.0) for _ in range(1000)])
    assert sum(nonsense) < 10
    good = accepted(gate, now_s + 1000 * DT_S, *[0.0] * 40)
    assert 12 <= good.index(True) <= 17
    assert all(good[17:])


def test_three_wrong_readings_in_a_row_make_a_part_erratic_and_two_do_not() -> None:
    gate, now_s = calm()
    assert accepted(gate, now_s, 1.0, -1.0, 0.0) == [False, False, True]
    gate, now_s = calm()
    assert accepted(gate, now_s, 1.0, -1.0, 1.0, 0.0) == [False] * 4


HEADED = HeadingReading(0.0, 1.0, 0.1, 0.05, -0.05)
FIXED = GnssFix(0.0, LatLon(50.0, -1.2), 3, 12, 0.9, 1.0, -1.0)
PACK = BatteryReading(0.0, 12.3, 4.0)
SOUNDED = DepthReading(0.0, 3.0)
NAN = math.nan


@pytest.mark.parametrize(
    ("reading", "limits", "field", "possible", "impossible", "left"),
    [
        (HEADED, HEADING, "yaw_rate_rad_s", 0.3, 0.45, None),
        (HEADED, HEADING, "yaw_rate_rad_s", 0.3, math.radians(2048.0), None),
        (HEADED, HEADING, "heading_rad", 1.2, 1.35, NAN),
        (HEADED, HEADING, "roll_rad", 0.6, 1.2, None),
        (HEADED, HEADING, "pitch_rad", -0.6, -1.2, None),
        (FIXED, FIX, "north_m_s", 2.5, 4.1, None),
        (FIXED, FIX, "east_m_s", -2.5, -4.1, None),
        (SOUNDED, DEPTH, "depth_m", 300.0, 11_001.0, None),
        (SOUNDED, DEPTH, "depth_m", 0.1, -0.1, None),
    ],
)  # fmt: skip
def test_an_impossible_value_is_missing_and_the_rest_of_its_reading_is_used(
    reading: GnssFix | HeadingReading | BatteryReading | DepthReading,
    limits: dict[str, Limit],
    field: str,
    possible: float,
    impossible: float,
    left: float | None,
) -> None:
    for value, expected in ((possible, possible), (impossible, left), (NAN, left)):
        gate: ReadingGate[Any] = ReadingGate(limits)
        assert gate.judge(reading) is reading
        changed: dict[str, Any] = {"time_s": 0.02, field: value}
        later = msgspec.structs.replace(reading, **changed)
        judged = known(gate.judge(later))
        wanted = msgspec.structs.asdict(reading) | changed | {field: expected}
        assert repr(msgspec.structs.asdict(judged)) == repr(wanted)  # NaN is NaN
        assert gate.judge(later) is judged, "one reading is judged once"


@pytest.mark.parametrize(
    ("voltage_v", "current_a", "is_possible"),
    [(10.6, 4.0, True), (9.7, 4.0, False), (0.0, 4.0, False), (NAN, 4.0, False), (12.3, 14.9, True),
     (12.3, 15.1, False), (12.3, NAN, False), (12.3, None, True)],
)  # fmt: skip
def test_a_battery_reading_with_an_impossible_value_is_not_used(
    voltage_v: float, current_a: float | None, *, is_possible: bool
) -> None:
    gate = ReadingGate[BatteryReading](BATTERY)
    assert gate.judge(PACK) is PACK
    later = BatteryReading(0.1, voltage_v, current_a)
    assert gate.judge(later) is (later if is_possible else PACK)
