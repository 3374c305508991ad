"""The u-blox driver against a receiver that follows the interface descriptions: set-up and faults."""

import pytest
from twins.ubx_bench import Bench
from twins.ubx_receiver import MAX_M10, NEO_6M, NEO_M8N, ZED_F9P, Model

from companion.sensors.gnss_heading import GnssHeading
from companion.sensors.ubx.setup import Phase

SEA = 5


@pytest.mark.parametrize("model", [NEO_M8N, ZED_F9P, MAX_M10], ids=lambda model: model.hardware)
@pytest.mark.parametrize("baud", [None, 4800, 115_200, 460_800])
def test_a_receiver_is_found_at_any_baud_rate_and_set_up(model: Model, baud: int | None) -> None:
    bench = Bench(model, baud=baud)
    bench.until_running()
    settings = bench.receiver.settings
    assert (settings.baud, settings.period_ms, settings.model) == (115_200, 200, SEA)
    assert not settings.nmea_out
    assert bench.texts == [bench.texts[-1]]
    bench.fixes.clear()
    bench.run(2.0)
    assert len(bench.fixes) == pytest.approx(10, abs=1)
    assert bench.receiver.other_layers == []  # only the volatile layer


def test_a_power_dip_is_followed_by_another_set_up() -> None:
    bench = Bench()
    bench.until_running()
    bench.run(3.0)
    bench.texts.clear()
    bench.receiver.dip()
    assert bench.until_running() < 10.0
    assert bench.texts[0] == "GNSS: receiver silent, setting it up again"
    assert "set up again" in bench.texts[-1]
    assert (bench.receiver.settings.baud, bench.receiver.settings.model) == (115_200, SEA)


@pytest.mark.parametrize("baud", [4800, 9600, 115_200])
def test_a_receiver_that_cannot_hear_is_read_as_it_is(baud: int) -> None:
    bench = Bench(NEO_M8N, baud=baud)
    bench.receiver.is_deaf = True
    bench.run(20.0)
    assert bench.phase is Phase.LISTENING
    assert bench.texts == ["GNSS: receiver does not answer: using its own settings"]
    fix = bench.run(2.0).fixes[-1]
    assert bench.clock() - fix.time_s < 2.5
    assert (fix.fix_type, fix.satellites) == (3, 9)
    bench.receiver.is_deaf = False  # the wire is put in its place
    bench.until_running(40.0)


@pytest.mark.parametrize(
    ("refused", "text"),
    [((0x06, 0x24), "sea model"), ((0x06, 0x08), "navigation rate"), ((0x06, 0x01), "output of messages")],
)
def test_a_refusal_is_reported_and_the_rest_is_set(refused: tuple[int, int], text: str) -> None:
    bench = Bench(NEO_M8N)
    bench.receiver.refused.add(refused)
    bench.run(15.0)
    assert f"GNSS: receiver refused: {text}" in bench.texts
    if text != "output of messages":
        assert bench.phase is Phase.RUNNING
        assert bench.fixes
    else:
        assert bench.phase is Phase.LISTENING
        assert bench.clock() - bench.run(2.0).fixes[-1].time_s < 2.5  # by its sentences


def test_a_receiver_that_acknowledges_nothing_is_still_read() -> None:
    bench = Bench(NEO_M8N)
    bench.receiver.unacknowledged = True
    bench.until_running(40.0)
    assert "GNSS: no acknowledgement: navigation rate" in bench.texts
    assert bench.receiver.settings.nmea_out
    assert bench.phase is Phase.RUNNING


@pytest.mark.parametrize(
    ("model", "rate_hz", "has_baseline", "period_ms"),
    [
        (NEO_M8N, 5.0, False, 200),
        (NEO_M8N, 10.0, False, 167),  # 6 Hz of 126 bytes
        (NEO_6M, 5.0, False, 500),  # 2 Hz of 260 bytes
        (ZED_F9P, 5.0, True, 333),  # 3 Hz of 198 bytes
    ],
)
def test_on_a_slow_line_the_rate_is_what_the_line_carries(
    model: Model, rate_hz: float, has_baseline: bool, period_ms: int
) -> None:
    heading = GnssHeading() if has_baseline else None
    bench = Bench(model, baud=9600, target_baud=9600, rate_hz=rate_hz, heading=heading)
    bench.until_running()
    assert bench.receiver.settings.period_ms == period_ms


def test_a_refused_baud_rate_leaves_the_one_that_works() -> None:
    bench = Bench(NEO_M8N)
    bench.receiver.refused.add((0x06, 0x00))
    bench.until_running()
    assert "GNSS: receiver silent at 115200 baud" in bench.texts
    assert bench.receiver.settings.baud == 9600
    assert bench.receiver.settings.model == SEA


@pytest.mark.parametrize("interface", ["UART1", "UART2", "USB"])
@pytest.mark.parametrize("is_usb", [False, True])
def test_the_connected_port_of_the_receiver_is_found(interface: str, is_usb: bool) -> None:
    bench = Bench(ZED_F9P, interface=interface, is_usb=is_usb)
    bench.until_running()
    assert bench.run(1.0).fixes


@pytest.mark.parametrize("model", [NEO_M8N, ZED_F9P, NEO_6M], ids=lambda model: model.hardware)
@pytest.mark.parametrize("dip_s", [0.2, 1.3, 1.9, 2.3, 2.7, 3.3])
def test_a_power_dip_at_any_moment_of_the_set_up_is_overcome(model: Model, dip_s: float) -> None:
    bench = Bench(model)
    bench.run(dip_s)
    bench.receiver.dip()
    bench.run(25.0)
    assert bench.phase is Phase.RUNNING
    settings = bench.receiver.settings
    assert (settings.baud, settings.period_ms, settings.model) == (115_200, 200, SEA)
    assert bench.clock() - bench.fixes[-1].time_s < 0.5
