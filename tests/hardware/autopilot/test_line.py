"""The parts behind an autopilot on one line: start, unplug, return and close."""

import pytest
from autopilot_bench import TICK_S, Plug, config
from twins.lines import HandClock, known

from companion.app.hardware import open_hardware
from companion.core.errors import ConfigError
from companion.hal.autopilot.line import (
    AutopilotMotors,
    AutopilotRudder,
    AutopilotSensor,
    AutopilotSonar,
)
from companion.links.retried import Pace


@pytest.fixture
def plug(clock: HandClock) -> Plug:
    return Plug(clock)


def test_a_line_is_silent_until_it_is_plugged_in_and_again_after_it_was_unplugged(plug: Plug) -> None:
    compass = AutopilotSensor(plug.line, lambda readings: readings.heading)
    plug.run(3.0)
    assert compass.read() is None
    for _ in range(2):
        plug.plug_in()
        plug.run(3.0)
        assert known(compass.read()).time_s == pytest.approx(plug.clock(), abs=0.05)
        plug.unplug()
        plug.run(1.0)
        assert known(compass.read()).time_s < plug.clock() - 0.9


def test_closing_the_line_stops_and_disarms_and_may_be_done_twice(plug: Plug) -> None:
    plug.plug_in()
    motors, rudder = AutopilotMotors(plug.line), AutopilotRudder(plug.line)
    plug.run(25.0)
    plug.line.allow(may_drive=True)
    motors.write(0.5, 0.5)
    rudder.write(0.0)
    plug.run(2.0)
    assert (plug.line.fault, plug.rover.is_armed) == ("", True)
    motors.close()
    rudder.close()
    plug.hear()
    plug.rover.step(TICK_S)
    assert (plug.rover.left, plug.rover.is_armed) == (0.0, False)


def test_pings_are_handed_over_once(plug: Plug) -> None:
    plug.plug_in()
    plug.run(1.5)
    sonar = AutopilotSonar(plug.line)
    sonar.set_sector(-1.0, 1.0)
    ping = plug.rover.wire.distance_sensor_encode(0, 20, 700, 150, 0, 0, 0, 0)
    known(plug.far).send(ping.pack(plug.rover.wire))
    plug.line.step()
    assert [one.range_m for one in sonar.read()] == [1.5]
    assert sonar.read() == []


def test_all_parts_share_one_line_which_joins_the_boat_later(clock: HandClock) -> None:
    hardware = open_hardware(config(url="tcpout:127.0.0.1:9"), clock, Pace(0.01, 0.01, 0.05))
    try:
        assert hardware.outputs is not None
        assert hardware.output_fault == "autopilot not heard yet"
        assert hardware.compass.read() is None
        assert any(one.name == "Autopilot tcpout:127.0.0.1:9" for one in hardware.retried)
    finally:
        hardware.close()


def test_a_url_that_is_none_is_refused(clock: HandClock) -> None:
    with pytest.raises(ConfigError, match="warp:9"):
        open_hardware(config(url="warp:9"), clock)
