"""Faults in the water: each is seen in the readings from its time on, and is gone after it."""

import math
from collections.abc import Iterator

import pytest

from companion.core.readings import BatteryReading, GnssFix, HeadingReading, SonarReading
from sitl.scenarios.scenario import load_scenario
from sitl.world.world import Truth, World

DT_S = 0.02
AT_S, FOR_S = 2.0, 6.0


def world(fault: str, *overrides: str) -> World:
    table = f"{{{fault}, at_s={AT_S}, for_s={FOR_S}}}"
    return World(load_scenario("open", [f"faults=[{table}]", *overrides]))


def live(water: World, until_s: float, command: float = 0.0) -> Iterator[Truth]:
    water.hardware.motors.write(command, command)
    while water.time_s < until_s - 1e-9:
        yield water.step(DT_S)


def fixes(fault: str, until_s: float = 12.0, *overrides: str) -> list[tuple[float, GnssFix, Truth]]:
    """Each new fix with its time of arrival and the truth of then."""
    water = world(f'what="gnss", {fault}', *overrides)
    out: list[tuple[float, GnssFix, Truth]] = []
    for truth in live(water, until_s, 0.6):
        fix = water.hardware.gnss.read()
        if fix is not None and (not out or fix is not out[-1][1]):
            out.append((truth.time_s, fix, truth))
    return out


def error_m(water_fix: tuple[float, GnssFix, Truth]) -> float:
    _, fix, truth = water_fix
    frame = load_scenario("open").frame
    here = frame.to_local(fix.position)
    return math.hypot(here.north_m - truth.north_m, here.east_m - truth.east_m)


def parted(rows: list[tuple[float, GnssFix, Truth]]) -> tuple[list[tuple[float, GnssFix, Truth]], ...]:
    """Before, during and after, by what was measured then."""
    before = [row for row in rows if row[0] < AT_S]
    during = [row for row in rows if AT_S + 0.3 <= row[0] < AT_S + FOR_S]
    after = [row for row in rows if row[0] >= AT_S + FOR_S + 0.4]
    assert before
    assert after
    return before, during, after


def test_a_receiver_that_is_off_is_silent_and_comes_back() -> None:
    _, during, _ = parted(fixes('kind="off"'))
    assert during == []


def test_a_frozen_receiver_repeats_itself_with_fresh_stamps() -> None:
    _, during, after = parted(fixes('kind="stuck"'))
    assert len({fix.position for _, fix, _ in during}) == 1
    assert len({(fix.north_m_s, fix.east_m_s) for _, fix, _ in during}) == 1
    assert all(now_s - fix.time_s < 0.3 for now_s, fix, _ in during)
    assert len({fix.position for _, fix, _ in after}) == len(after)


def test_a_jumping_receiver_is_off_by_its_size_and_then_right_again() -> None:
    before, during, after = parted(fixes('kind="wrong", size=40, towards_deg=90'))
    assert all(abs(error_m(row) - 40.0) < 2.0 for row in during)
    assert all(error_m(row) < 2.0 for row in before + after)


def test_a_spoofed_receiver_is_pulled_away_slowly_and_is_sure_of_itself() -> None:
    before, during, _ = parted(fixes('kind="drift", size=1.0, towards_deg=180'))
    pulled_m = [error_m(row) for row in during]
    assert pulled_m[-1] == pytest.approx(5.8, abs=1.2)
    assert pulled_m[0] < 2.0
    assert {fix.horizontal_accuracy_m for _, fix, _ in during} == {before[0][1].horizontal_accuracy_m}


def test_a_jammed_receiver_gets_noisy_then_stands_still_without_a_fix() -> None:
    _, during, after = parted(fixes('kind="jammed", size=3'))
    noisy = [row for row in during if row[0] < AT_S + 3.0]
    lost = [row for row in during if row[0] > AT_S + 3.3]
    assert {fix.fix_type for _, fix, _ in noisy} == {3}
    assert max(error_m(row) for row in noisy[len(noisy) // 2 :]) > 3.0
    assert {fix.fix_type for _, fix, _ in lost} == {1}
    assert len({fix.position for _, fix, _ in lost}) == 1
    assert max(error_m(row) for row in after) < 2.0


def test_a_delayed_receiver_is_late_and_does_not_know_it() -> None:
    _, during, _ = parted(fixes('kind="delayed", size=2'))
    late = [row for row in during if row[0] > AT_S + 2.5]
    assert late
    assert all(now_s - fix.time_s < 0.3 for now_s, fix, _ in late)
    # The boat makes 2 m/s or less: what it hears is where it was two seconds ago.
    behind = late[-1]
    assert error_m(behind) > 1.0


def headings(fault: str, what: str = "compass") -> dict[str, list[tuple[float, HeadingReading, Truth]]]:
    water = world(f'what="{what}", {fault}')
    out: dict[str, list[tuple[float, HeadingReading, Truth]]] = {"before": [], "during": [], "after": []}
    for truth in live(water, 12.0):
        reading = water.hardware.compass.read()
        assert reading is not None
        if truth.time_s < AT_S - 0.01:
            phase = "before"
        elif truth.time_s < AT_S + FOR_S - 0.01:
            phase = "during"
        else:
            phase = "after"
        out[phase].append((truth.time_s, reading, truth))
    return out


def off_deg(row: tuple[float, HeadingReading, Truth]) -> float:
    return math.degrees(math.remainder(row[1].heading_rad - row[2].heading_rad, 2.0 * math.pi))


def test_a_stuck_compass_repeats_its_heading_while_the_gyro_goes_on() -> None:
    rows = headings('kind="stuck"')["during"]
    assert len({reading.heading_rad for _, reading, _ in rows}) == 1
    assert len({reading.yaw_rate_rad_s for _, reading, _ in rows}) > 100
    assert rows[-1][1].time_s == pytest.approx(rows[-1][0])


def test_a_wrong_compass_is_off_by_its_size() -> None:
    rows = headings('kind="wrong", size=30')
    assert all(abs(off_deg(row) - 31.0) < 5.0 for row in rows["during"])
    assert all(abs(off_deg(row) - 1.0) < 5.0 for row in rows["before"] + rows["after"])


@pytest.mark.parametrize(
    ("fault", "rates"),
    [('kind="off"', {None}), ('kind="stuck"', 1), ('kind="wrong", size=20', None)],
)
def test_the_gyro_fails_apart_from_the_compass(fault: str, rates: object) -> None:
    rows = headings(fault, "gyro")
    heard = [reading.yaw_rate_rad_s for _, reading, _ in rows["during"]]
    assert all(abs(off_deg(row) - 1.0) < 5.0 for row in rows["during"])
    if rates is None:
        assert all(rate is not None and abs(math.degrees(rate) - 20.1) < 2.0 for rate in heard)
    elif rates == 1:
        assert len(set(heard)) == 1
    else:
        assert set(heard) == rates
    assert all(reading.yaw_rate_rad_s is not None for _, reading, _ in rows["after"])


def pings(fault: str) -> dict[str, list[SonarReading]]:
    water = World(
        load_scenario(
            "open",
            [
                f'faults=[{{what="sonar", {fault}, at_s={AT_S}, for_s={FOR_S}}}]',
                "movers=[{start=[0, 3], radius_m=1.0}]",
                "sensors.sonar.sweep_deg=0",
                "boat.heading_deg=0",
                "sensors.sonar.noise_m=0",
                "sensors.sonar.ghost_share=0",
            ],
        )
    )
    out: dict[str, list[SonarReading]] = {"before": [], "during": [], "after": []}
    for truth in live(water, 12.0):
        phase = "before" if truth.time_s < AT_S else "during" if truth.time_s < AT_S + FOR_S else "after"
        out[phase] += water.hardware.sonar.read() if water.hardware.sonar else []
    return out


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
    heard = pings(fault)
    assert {ping.range_m and round(ping.range_m, 6) for ping in heard["during"]} == ranges
    for phase in ("before", "after"):
        assert {ping.range_m and round(ping.range_m, 6) for ping in heard[phase]} == {2.0}


def batteries(fault: str) -> dict[str, list[BatteryReading]]:
    water = world(f'what="battery", {fault}')
    out: dict[str, list[BatteryReading]] = {"before": [], "during": [], "after": []}
    for truth in live(water, 12.0, 0.5):
        reading = water.hardware.battery.read() if water.hardware.battery else None
        assert reading is not None
        phase = "before" if truth.time_s < AT_S else "during" if truth.time_s < AT_S + FOR_S else "after"
        out[phase].append(reading)
    return out


def test_a_monitor_that_is_stuck_or_wrong() -> None:
    stuck = batteries('kind="stuck"')["during"]
    assert len({(row.voltage_v, row.current_a) for row in stuck}) == 1
    assert stuck[-1].time_s > AT_S + FOR_S - 0.2
    rows = batteries('kind="wrong", size=-3')
    assert rows["during"][-1].voltage_v == pytest.approx(rows["after"][-1].voltage_v - 3.0, abs=0.2)


def thrusts(fault: str, until_s: float = 12.0) -> dict[str, list[float]]:
    water = world(f'what="motor_left", {fault}')
    out: dict[str, list[float]] = {"before": [], "during": [], "after": []}
    for truth in live(water, until_s, 0.6):
        if 1.5 < truth.time_s < AT_S:
            out["before"].append(truth.left_thrust_n)
        elif AT_S + 1.5 < truth.time_s < AT_S + FOR_S:
            out["during"].append(truth.left_thrust_n)
        elif truth.time_s > AT_S + FOR_S + 1.5:
            out["after"].append(truth.left_thrust_n)
        assert truth.right_thrust_n >= 0.0
    return out


def test_a_dead_motor_gives_no_thrust_until_it_lives_again() -> None:
    thrust_n = thrusts('kind="off"')
    assert max(map(abs, thrust_n["during"])) < 0.05
    assert min(thrust_n["before"]) > 0.3
    assert min(thrust_n["after"]) > 0.3


def test_weed_takes_thrust_and_a_seized_propeller_gives_none() -> None:
    clean = thrusts('kind="slow", size=1.0')["during"][-1]
    weedy = thrusts('kind="weed", size=0.2')["during"][-1]
    assert 0.0 < weedy < 0.75 * clean
    assert abs(thrusts('kind="stuck"')["during"][-1]) < 0.05 * clean


def test_a_loose_contact_comes_and_goes() -> None:
    thrust_n = thrusts('kind="intermittent", size=4')
    assert min(thrust_n["during"]) < 0.1
    assert max(thrust_n["during"]) > 0.3
    assert min(thrust_n["after"]) > 0.3


def test_the_same_seed_gives_the_same_faulty_readings() -> None:
    def heard(seed: int) -> list[tuple[float, GnssFix]]:
        return [row[:2] for row in fixes('kind="jammed"', 10.0, f"seed={seed}")]

    assert heard(3) == heard(3)
    assert heard(3) != heard(4)


def test_a_later_fault_takes_the_place_of_an_earlier_one_and_outlasts_its_end() -> None:
    faults = '[{what="gnss", kind="no_fix", at_s=1, for_s=3}, {what="gnss", kind="stuck", at_s=2, for_s=4}]'
    water = World(load_scenario("open", [f"faults={faults}"]))
    active = water.electronics.faults.active
    seen = {}
    for truth in live(water, 7.0):
        seen[round(truth.time_s, 2)] = {what: fault.kind for what, fault in active.items()}
    assert [seen[at] for at in (0.5, 1.5, 2.5, 4.5, 5.98, 6.02)] == [
        {},
        {"gnss": "no_fix"},
        {"gnss": "stuck"},
        {"gnss": "stuck"},
        {"gnss": "stuck"},
        {},
    ]
