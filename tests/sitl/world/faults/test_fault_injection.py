"""Faults by command, by parameter and by schedule, end to end in lockstep over MAVLink."""

import math

import pytest

from companion.core.storage import MemoryStorage
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem
from mission_tools.station.outcome import Accepted, Outcome
from mission_tools.station.wire import command_long
from sitl.run.lockstep import Lockstep
from sitl.scenarios.scenario import load_scenario

OK, DENIED, UNSUPPORTED = 0, 2, 3
GPS, MAG, GYRO, SONAR, BATTERY, MOTOR, LINK, SERVO = 4, 2, 0, 7, 100, 101, 105, 102
WELL, OFF, STUCK, GARBAGE, WRONG, SLOW, DELAYED, INTERMITTENT = range(8)
PARTS = {GPS: "gnss", MAG: "compass", GYRO: "gyro", SONAR: "sonar", BATTERY: "battery", LINK: "link"}


def lockstep(*settings: str, storage: MemoryStorage | None = None) -> Lockstep:
    return Lockstep(load_scenario("open", settings), storage)


def run(boat: Lockstep, seconds: float) -> None:
    until_s = boat.time_s + seconds
    while boat.time_s < until_s - 1e-9:
        boat.step()


def inject(boat: Lockstep, unit: float, failure: float, instance: float = 0.0) -> int:
    order(boat, dialect.MAV_CMD_INJECT_FAILURE, unit, failure, instance)
    boat.station.latest.pop("COMMAND_ACK", None)
    for _ in range(10):
        boat.step()
    answer: int = boat.station.latest["COMMAND_ACK"].result
    return answer


def order(boat: Lockstep, number: int, *params: float) -> None:
    boat.station.send(command_long(boat.station.boat, number, *params))


def set_parameter(boat: Lockstep, name: str, value: float) -> None:
    target = (boat.station.boat.system, boat.station.boat.component)
    boat.station.send(dialect.MAVLink_param_set_message(*target, name.encode(), value, 9))
    run(boat, 0.1)


def active(boat: Lockstep) -> dict[str, str]:
    return {what: fault.kind for what, fault in boat.world.electronics.faults.active.items()}


def test_parts_fail_by_command_and_are_well_by_command() -> None:
    boat = lockstep()
    run(boat, 1.0)
    for unit, failure, kind in (
        (GPS, OFF, "off"),
        (GPS, INTERMITTENT, "intermittent"),
        (MAG, STUCK, "stuck"),
        (MAG, DELAYED, "delayed"),
        (SONAR, GARBAGE, "garbage"),
        (BATTERY, SLOW, "slow"),
        (GYRO, WRONG, "wrong"),
    ):
        assert inject(boat, unit, failure) == OK
        assert active(boat) == {PARTS[unit]: kind}
        assert f"Fault: {PARTS[unit]} {kind}" in boat.station.texts
        assert inject(boat, unit, WELL) == OK
        assert active(boat) == {}
    for instance, hit in ((1, {"motor_left"}), (2, {"motor_right"}), (0, {"motor_left", "motor_right"})):
        assert inject(boat, MOTOR, OFF, instance) == OK
        assert active(boat) == dict.fromkeys(hit, "off")
        assert inject(boat, MOTOR, WELL) == OK
    assert boat.boat.endpoint.faults == 0


def test_what_cannot_fail_so_is_refused() -> None:
    boat = lockstep()
    for unit, failure, instance, result in (
        (SERVO, OFF, 0, UNSUPPORTED),
        (GPS, 8, 0, UNSUPPORTED),
        (GPS, OFF, 2, UNSUPPORTED),
        (MOTOR, OFF, 3, UNSUPPORTED),
        (GYRO, SLOW, 0, UNSUPPORTED),
        (GPS, math.nan, 0, DENIED),
        (1.5, OFF, 0, DENIED),
    ):
        assert inject(boat, unit, failure, instance) == result
    assert active(boat) == {}


def test_injection_can_be_forbidden_by_parameter() -> None:
    boat = lockstep()
    set_parameter(boat, "SYS_FAILURE_EN", 0.0)
    assert inject(boat, GPS, OFF) == UNSUPPORTED
    set_parameter(boat, "SYS_FAILURE_EN", 1.0)
    assert inject(boat, GPS, OFF) == OK


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("SIM_GPS_DISABLE", 1.0, {"gnss": "off"}),
        ("SIM_GPS_JAM", 1.0, {"gnss": "jammed"}),
        ("SIM_GPS_GLITCH_X", 0.001, {"gnss": "wrong"}),
        ("SIM_MAG1_FAIL", 1.0, {"compass": "off"}),
        ("SIM_MAG1_FAIL", 2.0, {"compass": "stuck"}),
    ],
)
def test_parts_fail_by_parameter_too(name: str, value: float, expected: dict[str, str]) -> None:
    boat = lockstep()
    set_parameter(boat, name, value)
    assert active(boat) == expected
    set_parameter(boat, name, 0.0)
    assert active(boat) == {}


def test_a_glitch_in_degrees_moves_fixes_by_as_many_metres() -> None:
    boat = lockstep()
    run(boat, 1.0)
    set_parameter(boat, "SIM_GPS_GLITCH_X", -0.001)
    set_parameter(boat, "SIM_GPS_GLITCH_Y", 0.001)
    run(boat, 0.5)
    fix = boat.boat.sensors.fix
    assert fix is not None
    here = boat.world.scenario.frame.to_local(fix.position)
    lat_deg = boat.world.scenario.frame.origin.lat_deg
    truth = boat.world.truth
    assert here.north_m - truth.north_m == pytest.approx(-111.2, abs=1.0)
    assert here.east_m - truth.east_m == pytest.approx(111.3 * math.cos(math.radians(lat_deg)), abs=1.0)


def test_the_motors_named_by_the_mask_get_the_gain() -> None:
    boat = lockstep()
    set_parameter(boat, "SIM_ENGINE_FAIL", 2.0)
    assert active(boat) == {}
    set_parameter(boat, "SIM_ENGINE_MUL", 0.25)
    assert active(boat) == {"motor_right": "slow"}
    assert boat.world.electronics.faults.active["motor_right"].amount == 0.25
    set_parameter(boat, "SIM_ENGINE_FAIL", 0.0)
    assert active(boat) == {}


def test_a_power_cut_stops_the_motors_and_the_program_begins_anew_with_what_was_stored() -> None:
    storage = MemoryStorage()
    boat = lockstep('faults=[{what="computer", at_s=8, for_s=3}]', storage=storage)
    run(boat, 2.0)
    set_parameter(boat, "WP_RADIUS", 3.25)
    items = [MissionItem(frame=0, command=16, x=500000000, y=-12000000)] * 2
    answers: list[Outcome] = []
    boat.station.upload(items, answers.append, boat.time_s)
    run(boat, 1.0)
    assert isinstance(answers[0], Accepted)
    boat.world.hardware.motors.write(0.5, 0.5)
    before = boat.boat
    run(boat, 5.2)
    boat.station.latest.clear()
    run(boat, 2.0)
    assert boat.station.latest == {}
    assert (boat.world.truth.left_command, boat.world.truth.right_command) == (0.0, 0.0)
    run(boat, 5.0)
    assert boat.boat is not before
    assert "SYS_STATUS" in boat.station.latest
    assert boat.boat.parameters.config.guidance.waypoint_radius_m == 3.25
    assert len(boat.boat.endpoint.mission_items()) == 2
    assert not boat.boat.vehicle.armed


def test_a_full_disk_is_told_and_what_is_stored_later_is_kept() -> None:
    storage = MemoryStorage()
    boat = lockstep('faults=[{what="disk", at_s=1, for_s=3}]', storage=storage)
    run(boat, 2.0)
    set_parameter(boat, "WP_RADIUS", 3.25)
    assert b"WP_RADIUS" not in storage.content.get("params.parm", b"")
    assert any("No space left" in text for text in boat.station.texts)
    run(boat, 3.0)
    set_parameter(boat, "WP_RADIUS", 3.5)
    assert b"WP_RADIUS 3.5" in storage.content["params.parm"]


def test_a_clock_leaps_for_the_boat_and_its_readings_alike_and_never_goes_back() -> None:
    boat = lockstep('faults=[{what="clock", kind="wrong", size=100, at_s=2, for_s=3}]')
    run(boat, 3.0)
    fix = boat.boat.sensors.fix
    assert fix is not None
    assert boat.world.clock_s == pytest.approx(boat.time_s + 100.0)
    assert boat.world.clock_s - fix.time_s < 0.5
    run(boat, 4.0)
    assert boat.world.clock_s == pytest.approx(boat.time_s + 100.0)
    assert boat.boat.endpoint.faults == 0


def test_a_computer_that_is_too_slow_for_the_program_is_overloaded_until_it_is_well() -> None:
    boat = lockstep('faults=[{what="cpu", kind="slow", size=1.3, at_s=2, for_s=10}]')
    run(boat, 1.9)
    assert boat.boat.load == 0.0
    run(boat, 2.1)
    assert boat.boat.vehicle.arm(force=True).accepted
    run(boat, 6.0)
    assert boat.boat.load == 1.3
    assert any("Computer overloaded: load 130 %" in text for text in boat.station.texts)
    run(boat, 5.0)
    assert boat.boat.load == 0.0


@pytest.mark.parametrize("link", ["loss=0.3", "reordering=0.5"])
def test_an_upload_survives_a_bad_link(link: str) -> None:
    boat = lockstep(f"link.{link}")
    items = [MissionItem(frame=0, command=16, x=500000000, y=-12000000)] * 5
    answers: list[Outcome] = []
    boat.station.upload(items, answers.append, boat.time_s)
    while not answers:
        boat.step()
    assert isinstance(answers[0], Accepted)
    assert len(boat.boat.endpoint.mission_items()) == 5
