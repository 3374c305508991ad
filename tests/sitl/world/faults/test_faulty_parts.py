"""Faults in the water: each is seen in the readings from its time on, and is gone after it."""

import math
from collections.abc import Callable, Iterable
from typing import Any

import pytest

from companion.core.readings import GnssFix
from sitl.radio.channel import WHOLE, Quality
from sitl.scenarios.scenario import load_scenario
from sitl.world.truth import Truth
from sitl.world.world import World

DT_S = 0.02
AT_S, FOR_S = 2.0, 6.0
END_S = 12.0
FRAME = load_scenario("open").frame
ROCK_AHEAD = (
    "movers=[{start=[0, 3], radius_m=1.0}]", "boat.heading_deg=0", "sensors.sonar.sweep_deg=0",
    "sensors.sonar.noise_m=0", "sensors.sonar.ghost_share=0", "sensors.sonar.scatter_db=0",
)  # fmt: skip

Row = tuple[Truth, Any]  # what a part says, and the truth of then


def observed(
    fault: str,
    read: Callable[[World], Iterable[Any]],
    *settings: str,
    throttle: float = 0.6,
    skip_s: float = 0.4,
) -> tuple[list[Row], list[Row], list[Row]]:
    """Before, during and after a fault, without the first moments of the fault and of what follows it."""
    table = f"faults=[{{{fault}, at_s={AT_S}, for_s={FOR_S}}}]"
    water = World(load_scenario("open", [table, *settings]))
    water.hardware.motors.write(throttle, throttle)
    before, during, after = list[Row](), list[Row](), list[Row]()
    while water.time_s < END_S:
        truth = water.step(DT_S)
        rows = [(truth, one) for one in read(water)]
        if truth.time_s < AT_S - 0.01:
            before += rows
        elif AT_S + skip_s <= truth.time_s < AT_S + FOR_S - 0.01:
            during += rows
        elif truth.time_s >= AT_S + FOR_S + skip_s:
            after += rows
    assert before
    assert after
    return before, during, after


def fixes(fault: str, *settings: str) -> tuple[list[Row], list[Row], list[Row]]:
    """Each new fix."""
    heard: list[GnssFix] = []

    def read(water: World) -> list[GnssFix]:
        fix = water.hardware.gnss.read()
        if fix is None or (heard and fix is heard[-1]):
            return []
        heard.append(fix)
        return [fix]

    return observed(f'what="gnss", {fault}', read, *settings)


def error_m(row: Row) -> float:
    truth, fix = row
    here = FRAME.to_local(fix.position)
    return math.hypot(here.north_m - truth.north_m, here.east_m - truth.east_m)


def test_a_frozen_receiver_repeats_itself_with_fresh_stamps() -> None:
    _, during, after = fixes('kind="stuck"')
    assert len({(fix.position, fix.north_m_s, fix.east_m_s) for _, fix in during}) == 1
    assert all(truth.time_s - fix.time_s < 0.3 for truth, fix in during)
    assert len({fix.position for _, fix in after}) == len(after)


def test_a_jumping_receiver_is_off_by_its_size_and_then_right_again() -> None:
    before, during, after = fixes('kind="wrong", size=40, towards_deg=90')
    assert all(abs(error_m(row) - 40.0) < 2.0 for row in during)
    assert all(error_m(row) < 2.0 for row in before + after)


def test_a_spoofed_receiver_is_pulled_away_slowly_and_is_sure_of_itself() -> None:
    before, during, _ = fixes('kind="drift", size=1.0, towards_deg=180')
    assert error_m(during[-1]) == pytest.approx(5.8, abs=1.2)
    assert error_m(during[0]) < 2.0
    assert {fix.horizontal_accuracy_m for _, fix in during} == {before[0][1].horizontal_accuracy_m}


def test_a_jammed_receiver_gets_noisy_then_stands_still_without_a_fix() -> None:
    before, during, after = fixes('kind="jammed", size=3')
    noisy = [row for row in during if row[0].time_s < AT_S + 3.0]
    lost = [fix for truth, fix in during if truth.time_s > AT_S + 3.3]
    assert {fix.fix_type for _, fix in before + noisy} == {3}
    assert max(error_m(row) for row in noisy[len(noisy) // 2 :]) > 3.0
    assert noisy[0][1].satellites > noisy[-1][1].satellites >= 4
    assert noisy[0][1].hdop < noisy[-1][1].hdop
    assert {fix.fix_type for fix in lost} == {1}
    assert {(fix.satellites, fix.hdop, fix.north_m_s) for fix in lost} == {(2, 99.0, None)}
    assert len({fix.position for fix in lost}) == 1
    assert max(error_m(row) for row in after) < 2.0


def test_a_delayed_receiver_is_late_and_does_not_know_it() -> None:
    _, during, _ = fixes('kind="delayed", size=2')
    late = [row for row in during if row[0].time_s > AT_S + 2.5]
    assert all(truth.time_s - fix.time_s < 0.3 for truth, fix in late)
    assert error_m(late[-1]) > 1.0  # the boat makes 2 m/s or less


def headings(fault: str) -> tuple[list[Row], list[Row], list[Row]]:
    return observed(fault, lambda water: [water.hardware.compass.read()], throttle=0.0)


def off_deg(row: Row) -> float:
    return math.degrees(math.remainder(row[1].heading_rad - row[0].heading_rad, math.tau))


def test_a_stuck_compass_repeats_its_heading_while_the_gyro_goes_on() -> None:
    _, rows, _ = headings('what="compass", kind="stuck"')
    assert len({reading.heading_rad for _, reading in rows}) == 1
    assert len({reading.yaw_rate_rad_s for _, reading in rows}) > 100
    assert rows[-1][1].time_s == pytest.approx(rows[-1][0].time_s)


def test_a_wrong_compass_is_off_by_its_size() -> None:
    before, during, after = headings('what="compass", kind="wrong", size=30')
    assert all(abs(off_deg(row) - 31.0) < 5.0 for row in during)
    assert all(abs(off_deg(row) - 1.0) < 5.0 for row in before + after)


@pytest.mark.parametrize(
    ("fault", "is_so"),
    [
        ('kind="off"', lambda rates: rates == {None}),
        ('kind="stuck"', lambda rates: len(rates) == 1),
        ('kind="wrong", size=20', lambda rates: all(abs(math.degrees(one) - 20.1) < 2.0 for one in rates)),
    ],
)
def test_the_gyro_fails_apart_from_the_compass(fault: str, is_so: Callable[[set[Any]], bool]) -> None:
    _, during, after = headings(f'what="gyro", {fault}')
    assert all(abs(off_deg(row) - 1.0) < 5.0 for row in during)
    assert is_so({reading.yaw_rate_rad_s for _, reading in during})
    assert all(reading.yaw_rate_rad_s is not None for _, reading in after)


@pytest.mark.parametrize(
    ("fault", "ranges"),
    [
        ('kind="deaf"', {None}),
        ('kind="stuck"', {2.0}),
        ('kind="wrong", size=-0.5', {1.5}),
        ('kind="off"', set()),
    ],
)
def test_a_faulty_sonar_hears_what_its_fault_says(fault: str, ranges: set[float | None]) -> None:
    def read(water: World) -> Iterable[Any]:
        return water.hardware.sonar.read() if water.hardware.sonar else []

    rows = observed(f'what="sonar", {fault}', read, *ROCK_AHEAD, throttle=0.0)
    heard = [{ping.range_m and round(ping.range_m, 6) for _, ping in phase} for phase in rows]
    assert heard == [{2.0}, ranges, {2.0}]


def test_a_monitor_that_is_stuck_or_wrong() -> None:
    def read(water: World) -> list[Any]:
        return [water.hardware.battery.read() if water.hardware.battery else None]

    _, stuck, _ = observed('what="battery", kind="stuck"', read)
    assert len({(reading.voltage_v, reading.current_a) for _, reading in stuck}) == 1
    assert stuck[-1][1].time_s > AT_S + FOR_S - 0.2
    _, wrong, after = observed('what="battery", kind="wrong", size=-3', read)
    assert wrong[-1][1].voltage_v == pytest.approx(after[-1][1].voltage_v - 3.0, abs=0.2)


@pytest.mark.parametrize(
    ("part", "value", "low", "high"),
    [
        ("battery", lambda parts: parts.battery.read().voltage_v, 0.0, 32.0),
        ("battery", lambda parts: parts.battery.read().current_a, -50.0, 50.0),
        ("compass", lambda parts: parts.compass.read().heading_rad, -math.pi, math.pi),
        ("gyro", lambda parts: parts.compass.read().yaw_rate_rad_s, -math.pi / 3.0, math.pi / 3.0),
        ("sonar", lambda parts: [one.range_m for one in parts.sonar.read()][-1:], 0.02, 4.0),
        ("depth", lambda parts: parts.depth.read().depth_m, 0.3, 50.0),
        ("rc", lambda parts: parts.rc.read().channels_us[2], 700, 2300),
    ],
)
def test_garbage_is_anywhere_in_the_range_of_the_part(
    part: str, value: Callable[[Any], Any], low: float, high: float
) -> None:
    def read(water: World) -> list[float]:
        found = value(water.hardware)
        return found if isinstance(found, list) else [found]

    fitted = ("sensors.depth.fitted=true", "sensors.depth.latency_s=0", "sensors.rc.fitted=true")
    _, during, _ = observed(f'what="{part}", kind="garbage"', read, *fitted)
    values = [one for _, one in during]
    assert low <= min(values) < low + 0.1 * (high - low)
    assert high - 0.1 * (high - low) < max(values) <= high


def test_a_corrupt_receiver_is_far_off_now_and_then_and_never_says_what_is_no_number() -> None:
    _, during, _ = fixes('kind="corrupt", size=1')
    errors_m = [error_m(row) for row in during]
    assert all(math.isfinite(one) for one in errors_m)
    assert 0.1 < sum(one > 100.0 for one in errors_m) / len(errors_m) < 0.7


def test_a_receiver_without_a_fix_says_so() -> None:
    _, during, _ = fixes('kind="no_fix"')
    assert {(fix.fix_type, fix.satellites, fix.hdop, fix.east_m_s) for _, fix in during} == {
        (1, 2, 99.0, None)
    }


@pytest.mark.parametrize(
    ("part", "value", "full_scale"),
    [
        ("battery", lambda parts: parts.battery.read().voltage_v, 40.96),
        ("battery", lambda parts: parts.battery.read().current_a, 81.92),
        ("compass", lambda parts: parts.compass.read().heading_rad, math.radians(2048.0)),
        ("gyro", lambda parts: parts.compass.read().yaw_rate_rad_s, math.radians(2048.0)),
    ],
)
def test_wrong_bits_reach_as_far_as_the_numbers_of_the_part(
    part: str, value: Callable[[Any], float], full_scale: float
) -> None:
    _, during, _ = observed(f'what="{part}", kind="corrupt", size=1', lambda water: [value(water.hardware)])
    values = [one for _, one in during if not math.isnan(one)]
    assert min(values) == pytest.approx(-full_scale)
    assert max(values) <= full_scale


def test_a_drifting_compass_is_off_by_its_size_for_every_second() -> None:
    _, during, _ = headings('what="compass", kind="drift", size=5')
    for row in during:
        assert off_deg(row) == pytest.approx(1.0 + 5.0 * (row[0].time_s - AT_S), abs=4.0)


def test_a_receiver_whose_transmitter_is_lost_says_so_or_sends_preset_pulses() -> None:
    def read(water: World) -> list[Any]:
        return [water.hardware.rc.read() if water.hardware.rc else None]

    _, lost, after = observed('what="rc", kind="failsafe"', read, "sensors.rc.fitted=true")
    assert {(one.is_failsafe, one.quality) for _, one in lost} == {(True, 0.0)}
    assert not any(one.is_failsafe for _, one in after)
    _, preset, _ = observed('what="rc", kind="wrong", size=950', read, "sensors.rc.fitted=true")
    assert {one.channels_us[:4] for _, one in preset} == {(1500, 1500, 950, 1500)}


@pytest.mark.parametrize(
    ("fault", "least_n", "most_n"),
    [
        ('kind="off"', -0.05, 0.05),
        ('kind="stuck"', -0.05, 0.05),
        ('kind="weed", size=0.2', 0.05, 0.8),
        ('kind="wrong"', -2.0, -0.1),
    ],
)
def test_a_faulty_motor_gives_the_thrust_that_is_left_until_it_is_well(
    fault: str, least_n: float, most_n: float
) -> None:
    rows = observed(f'what="motor_left", {fault}', lambda water: [water.truth.left_thrust_n], skip_s=1.5)
    before, during, after = ([thrust_n for _, thrust_n in phase] for phase in rows)
    assert least_n <= min(during[-50:]) <= max(during[-50:]) <= most_n
    assert min(before[-10:]) > 0.8
    assert min(after) > 0.8


def test_a_loose_contact_comes_and_goes() -> None:
    fault = 'what="motor_left", kind="intermittent", size=4'
    _, during, after = observed(fault, lambda water: [water.truth.left_thrust_n], skip_s=1.5)
    assert min(thrust_n for _, thrust_n in during) < 0.1
    assert max(thrust_n for _, thrust_n in during) > 0.3
    assert min(thrust_n for _, thrust_n in after) > 0.3


@pytest.mark.parametrize(
    ("fault", "quality"),
    [
        ('kind="off"', Quality(loss=1.0)),
        ('kind="lossy", size=0.25', Quality(loss=0.25)),
        ('kind="delayed", size=2', Quality(delay_s=2.0)),
        ('kind="slow", size=300', Quality(bandwidth_bytes_s=300.0)),
    ],
)
def test_a_faulty_link_has_the_quality_of_its_fault_until_it_is_well(fault: str, quality: Quality) -> None:
    water = World(load_scenario("open", [f'faults=[{{what="link", {fault}, at_s=0.1, for_s=0.1}}]']))
    seen = []
    for _ in range(15):
        water.step(DT_S)
        seen.append(water.electronics.computer.link_quality)
    assert (seen[0], seen[7], seen[-1]) == (WHOLE, quality, WHOLE)


def test_a_later_fault_takes_the_place_of_an_earlier_one_and_outlasts_its_end() -> None:
    faults = '[{what="gnss", kind="no_fix", at_s=1, for_s=3}, {what="gnss", kind="stuck", at_s=2, for_s=4}]'
    water = World(load_scenario("open", [f"faults={faults}"]))
    active, seen = water.electronics.faults.active, dict[float, dict[str, str]]()
    while water.time_s < 7.0:
        time_s = water.step(DT_S).time_s
        seen[round(time_s, 2)] = {what: fault.kind for what, fault in active.items()}
    no_fix, stuck = {"gnss": "no_fix"}, {"gnss": "stuck"}
    assert [seen[at] for at in (0.5, 1.5, 2.5, 4.5, 5.98, 6.02)] == [{}, no_fix, stuck, stuck, stuck, {}]
