"""Motors and rudder through ArduPilot Rover: its arming, its mixer, and every way in which it may fail."""

import math

import pytest
from autopilot_bench import Bench, config
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.rover import AS_DELIVERED, HOLD, MANUAL

from companion.app.composition import check_autopilot
from companion.config.boat_config import decode_config
from companion.core.errors import ConfigError
from companion.hal.autopilot.link import AutopilotLink
from companion.hal.autopilot.parameters import demands

ACRO = 1
ARM = 400
share = st.floats(-1.0, 1.0)


def arms(bench: Bench) -> list[tuple[int, float, float]]:
    return [one for one in bench.rover.commands if one[0] == ARM]


def test_it_is_no_fault_of_motors_that_are_the_boats_own_and_one_of_others_from_the_start() -> None:
    own = decode_config({"parts": {"autopilot": "tcp:a:1", "motors": {"driver": "l298n"}}}, "test")
    assert (Bench().outputs.fault, AutopilotLink(own).outputs.fault) == ("not heard yet", "")


def test_motors_are_off_until_the_boat_is_armed() -> None:
    bench = Bench().ready()
    bench.demand = 1.0, 1.0
    bench.run(2.0)
    assert (bench.rover.is_armed, bench.rover.left, arms(bench)) == (False, 0.0, [])


def test_it_is_armed_in_manual_with_the_boat_and_disarmed_with_it() -> None:
    bench = Bench().driving(0.5, 0.3)
    assert (bench.rover.is_armed, bench.rover.mode) == (True, MANUAL)
    assert (bench.rover.left, bench.rover.right) == pytest.approx((0.5, 0.3), abs=0.003)
    bench.outputs.may_drive = False
    bench.run(0.1)
    assert (bench.rover.is_armed, arms(bench)[-1]) == (False, (ARM, 0.0, 21196.0))


@settings(max_examples=20)
@given(share, share, st.booleans(), st.booleans())
def test_each_pair_of_shares_comes_out_of_the_mixer(
    left: float,
    right: float,
    turned: bool,
    lopsided: bool,
) -> None:
    bench = Bench()
    bench.rover.parameters |= {"RC1_REVERSED": float(turned)} | ({"RC3_TRIM": 1400.0} if lopsided else {})
    bench.driving(left, right)
    assert (bench.rover.left, bench.rover.right) == pytest.approx((left, right), abs=0.006)


@pytest.mark.parametrize(("throttle", "rudder"), [(0.6, 0.4), (-0.5, 0.4), (0.0, -1.0)])
def test_motor_and_rudder_come_out_as_they_are_also_astern(throttle: float, rudder: float) -> None:
    bench = Bench("rudder")
    bench.outputs.write_rudder(rudder)
    bench.driving(throttle, throttle)
    assert (bench.rover.left, bench.rover.right) == pytest.approx((throttle, rudder), abs=0.003)


@pytest.mark.parametrize("demand", [(math.nan, 0.5), (0.5, math.inf)])
def test_a_demand_that_is_not_finite_stops_both_motors(demand: tuple[float, float]) -> None:
    bench = Bench().driving()
    bench.demand = demand
    bench.run(0.2)
    assert (bench.rover.left, bench.rover.right) == (0.0, 0.0)


def test_its_reason_for_not_arming_is_the_boats() -> None:
    bench = Bench()
    bench.rover.refusal = "Compass not healthy"
    bench.run(20.0)
    assert bench.outputs.fault == "Compass not healthy"
    bench.rover.refusal = ""
    bench.run(1.0)
    assert bench.outputs.fault == ""


def test_a_refusal_ends_in_an_error_with_its_words() -> None:
    bench = Bench().ready()
    bench.rover.parameters["RC3_TRIM"] = 1300.0  # the neutral pulse is off its neutral
    bench.outputs.may_drive = True
    bench.run(3.9)
    assert bench.errors == []
    bench.run(0.2)
    assert set(bench.errors) == {"autopilot: Radio failsafe on"}


@pytest.mark.parametrize("demand", [one for one in demands(255, has_rudder=False) if one.is_needed])
def test_a_wrong_parameter_is_named_with_its_value_and_keeps_the_boat_from_arming(demand: object) -> None:
    names, wanted = demand.names, demand.wanted  # type: ignore[attr-defined]
    bench = Bench()
    bench.rover.parameters[names[0]] = 7.0 if names[0] != "FS_THR_ENABLE" else 0.0
    bench.outputs.may_drive = True
    bench.run(25.0)
    assert bench.outputs.fault.startswith(f"{names[0]} is ")
    assert bench.outputs.fault.endswith(wanted)
    assert not arms(bench)


def test_an_autopilot_as_delivered_is_told_what_to_set() -> None:
    bench = Bench()
    bench.rover.parameters = dict(AS_DELIVERED)
    bench.run(25.0)
    parameters = bench.outputs.parameters
    assert parameters.faults() == [
        "RC_OVERRIDE_TIME is 3, set it to 0.4",
        "PILOT_STEER_TYPE is 0, set it to 3",
    ]
    assert parameters.faults(is_needed=False) == ["MOT_SLEWRATE is 100, set it to 0"]


def test_a_rover_before_4_7_is_asked_by_the_old_name() -> None:
    bench = Bench()
    bench.rover.parameters["SYSID_MYGCS"] = bench.rover.parameters.pop("MAV_GCS_SYSID")
    bench.run(25.0)
    assert bench.outputs.parameters.faults() == []
    assert "MAV_GCS_SYSID" not in bench.outputs.parameters.values


def test_outputs_without_the_functions_of_motors_are_told() -> None:
    bench = Bench()
    bench.rover.parameters["SERVO3_FUNCTION"] = 0.0
    bench.run(25.0)
    assert bench.outputs.fault == "no SERVOn_FUNCTION is 74"


def test_a_parameter_that_is_changed_meanwhile_counts() -> None:
    bench = Bench().driving()
    bench.rover.parameters["RC_OVERRIDE_TIME"] = 3.0
    bench.rover._on_param_request_read(type("Asked", (), {"param_id": "RC_OVERRIDE_TIME"})())
    bench.run(0.2)
    assert bench.outputs.fault == "RC_OVERRIDE_TIME is 3, set it to 0.4"
    bench.run(1.0)
    assert bench.rover.left == 0.0


def test_another_autopilot_drives_no_motors() -> None:
    bench = Bench()
    bench.rover._report = lambda number, real=bench.rover._report: (  # type: ignore[method-assign,misc]
        type(real(0))(2, 12, 0x51, 0, 4, 3) if number == 0 else real(number)
    )
    bench.run(5.0)
    assert bench.outputs.fault == "is not ArduPilot Rover, which alone drives motors"


@pytest.mark.parametrize("way", ["hears", "is_heard"])
def test_a_line_that_is_cut_either_way_stops_the_motors_within_a_second_and_the_boat_goes_on_after(
    way: str,
) -> None:
    bench = Bench().driving()
    setattr(bench, way, False)
    bench.run(0.96)
    assert bench.rover.left == 0.0
    assert bench.outputs.fault
    bench.run(4.0)
    assert any(text.startswith("Motors off: autopilot") for text in bench.texts)
    assert bench.rover.mode == (MANUAL if way == "hears" else HOLD)
    setattr(bench, way, True)
    bench.run(3.0)
    assert bench.rover.left == pytest.approx(0.5, abs=0.003)
    assert bench.texts[-1] == "Autopilot drives the motors again"


def test_a_transmitter_whose_sticks_are_at_rest_is_not_taken_for_the_boats_overrides() -> None:
    bench = Bench().driving(0.0, 0.0)
    bench.rover.has_receiver, bench.is_heard = True, False
    bench.run(2.0)
    assert (bench.rover.mode, bench.outputs.fault) == (MANUAL, "ignores the boat's channels")
    bench.is_heard = True
    bench.run(0.5)
    assert bench.outputs.fault == ""


def test_a_reboot_stops_the_motors_and_the_boat_goes_on_after() -> None:
    bench = Bench().driving()
    bench.rover.reboot()
    bench.run(0.5)
    assert bench.outputs.fault
    bench.run(15.0)
    assert bench.rover.left == pytest.approx(0.5, abs=0.003)
    assert bench.errors == []


@pytest.mark.parametrize("change", [{"is_armed": False}, {"mode": ACRO}])
def test_what_a_person_does_to_it_is_not_undone_and_its_channels_are_not_overridden(
    change: dict[str, int],
) -> None:
    bench = Bench().driving()
    bench.rover.has_receiver = True
    commands = len(bench.rover.commands)
    for name, value in change.items():
        setattr(bench.rover, name, value)
    bench.run(0.3)
    assert bench.outputs.fault in ("was disarmed", "has left MANUAL")
    bench.run(10.0)
    assert [one for one in bench.rover.commands[commands:] if one[0] in (ARM, 176)] == []
    if "mode" in change:
        assert bench.rover.now_s - bench.rover._override_s > 9.0
    bench.rover.is_armed, bench.rover.mode = True, MANUAL
    bench.run(3.0)
    assert bench.rover.left == pytest.approx(0.5, abs=0.003)


def test_outputs_that_do_not_return_end_in_an_error() -> None:
    bench = Bench(resume_s=10.0).driving()
    bench.rover.is_armed = False
    bench.run(9.8)
    assert bench.errors == []
    bench.run(0.6)
    assert set(bench.errors) == {"autopilot: was disarmed"}
    bench.outputs.may_drive = False
    bench.run(0.1)
    bench.errors.clear()
    bench.run(0.1)
    assert bench.errors == []


def test_an_autopilot_that_somebody_else_has_armed_is_left_alone_until_the_boat_is_armed() -> None:
    bench = Bench().ready()
    bench.rover.is_armed, bench.rover.mode = True, ACRO
    bench.run(2.0)
    assert bench.rover.is_armed
    assert bench.rover.now_s - bench.rover._override_s > 1.5


def test_another_system_id_takes_no_overrides_and_is_told() -> None:
    bench = Bench(own_system_id=42)
    bench.run(25.0)
    assert bench.outputs.fault == "MAV_GCS_SYSID is 255, set it to 42"


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        ({"parts": {"gnss": {"driver": "autopilot"}}}, "parts.autopilot: gnss is behind it"),
        (
            {
                "parts": {
                    "autopilot": "tcp:a:1",
                    "motors": {"driver": "none"},
                    "rudder": {"driver": "autopilot"},
                }
            },
            "parts.rudder.driver",
        ),
        (
            {"parts": {"autopilot": "tcp:a:1"}, "drive": {"layout": "differential_rudder"}},
            "expected two motors, or one",
        ),
        ({"parts": {"autopilot": "tcp:a:1"}, "rc": {"driver": "autopilot"}}, "rc.driver = 'autopilot'"),
    ],
)
def test_a_configuration_that_cannot_be_is_refused(tables: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        check_autopilot(decode_config(tables, "test"))


def test_an_autopilot_is_everything_that_the_file_does_not_name() -> None:
    parts = config("rudder").parts
    named = decode_config({"parts": {"autopilot": "tcp:a:1", "compass": {"driver": "none"}}}, "test").parts
    drivers = [one.driver for one in (parts.gnss, parts.compass, parts.battery, parts.motors, parts.rudder)]
    assert drivers == ["autopilot"] * 5
    assert (parts.sonar.driver, parts.depth.driver) == ("none", "none")
    assert (named.compass.driver, named.gnss.driver, named.rudder.driver) == ("none", "autopilot", "none")
