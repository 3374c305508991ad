"""The emulated payload records what it is given, lets its winch run and its programs end."""

import pytest
from boat_rig import scenario
from payload_rig import CAMERA, PAYLOAD, PUMP, SAMPLE, WINCH

from companion.core.errors import HardwareError
from sitl.world.payload import RUN_S, SimPayload

COUNTED = PAYLOAD.replace("line_m=5.0", "line_m=5.0, count_pin=24, pulse_m=0.1")


def payload() -> SimPayload:
    return SimPayload(scenario("open", COUNTED, CAMERA).vehicle)


def test_an_output_keeps_every_change_and_fails_where_it_should() -> None:
    sim = payload()
    pump = sim.outputs[PUMP]
    for value in (1.0, 1.0, 0.0):
        sim.step(sim.time_s + 1.0)
        pump.write(value)
    assert [tuple(one) for one in pump.history] == [(1.0, 1.0), (3.0, 0.0)]
    assert list(sim.lines) == ["relay 0 (pump): 1", "relay 0 (pump): 0"]
    pump.fault = "the wire has come off"
    with pytest.raises(HardwareError, match="the wire"):
        pump.write(1.0)


def test_a_winch_gives_a_pulse_for_each_length_of_its_line_until_it_is_stuck() -> None:
    sim = payload()
    counter = sim.counters[WINCH]
    sim.step(1.0)
    sim.outputs[WINCH].write(-1.0)
    sim.step(3.05)
    assert counter.count == 10  # 0.5 m/s
    counter.is_stuck = True
    sim.step(9.0)
    assert counter.count == 10


def test_a_program_runs_for_a_while_and_tells_its_end_once() -> None:
    sim = payload()
    sample, camera = sim.programs[SAMPLE], sim.capture
    assert camera is not None
    assert sample.poll() is None
    assert (sample.start(), camera.start()) == ("", "image-00001.jpg")
    sim.step(0.5 * RUN_S)
    assert sample.is_running
    assert sample.start() == ""
    assert (sample.starts, sample.poll()) == ([0.0], None)
    sim.step(RUN_S)
    assert [sample.poll(), sample.poll()] == ["", None]
    full_mb, free_mb = camera.space_mb()
    assert 0.0 < free_mb < full_mb
