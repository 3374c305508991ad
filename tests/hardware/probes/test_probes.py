"""Probes: inputs of an ADS1115, files as the kernel has them, lines of text; and their faults."""

import threading
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.battery import Ads1115Twin
from twins.i2c import plug_in
from twins.lines import HandClock, MemoryLine, known

from companion.app.composition import check_config
from companion.config.boat_config import decode_config
from companion.config.sensors import ProbePart
from companion.core.errors import ConfigError, HardwareError
from companion.core.readings import ProbeReading
from companion.hal.ads1115 import Ads1115
from companion.hal.probes import PolledProbe, SerialLine, file_number, raw_number, value_of
from companion.hal.raspberry_pi import open_i2c

W1_SLAVE = "72 01 4b 46 7f ff 0e 10 57 : crc=57 {crc}\n72 01 4b 46 7f ff 0e 10 57 t={milli}\n"
"""Linux, Documentation/w1/slaves/w1_therm.rst."""


def line_probe(name: str = "turbidity", **more: object) -> ProbePart:
    return ProbePart(**{"name": name, "driver": "serial", "port": "/dev/ttyUSB3", **more})  # type: ignore[arg-type]


# What a source says


@pytest.mark.parametrize(
    ("text", "more", "raw"),
    [
        ("12.5", {}, 12.5),
        (" -3e2\n", {}, -300.0),
        ("12.5 NTU", {}, None),
        ("", {}, None),
        ("7.01,25.3;1413", {"column": 1}, 25.3),
        ("7.01, 25.3 ; 1413", {"column": 2}, 1413.0),
        ("7.01,25.3", {"column": 2}, None),
        ("pH=7.01 T=25.3", {"pattern": r"pH=([-\d.]+)"}, 7.01),
        ("pH=? T=25.3", {"pattern": r"pH=([-\d.]+)"}, None),
        ("ERR", {"pattern": r"pH=([-\d.]+)"}, None),
    ],
)
def test_the_number_of_a_text(text: str, more: dict[str, object], raw: float | None) -> None:
    assert raw_number(text, line_probe("turbidity", **more)) == raw


def test_scale_offset_and_limits() -> None:
    part = line_probe(scale=2.0, offset=-1.0, invalid=(85000.0,), min_value=-5.0, max_value=9.0)
    assert value_of(3.0, part) == 5.0
    assert value_of(85000.0, part) is None
    assert [value_of(raw, part) for raw in (-2.1, 5.1, None)] == [None, None, None]
    assert (value_of(-2.0, part), value_of(5.0, part)) == (-5.0, 9.0)
    for raw in (float("nan"), float("inf"), 1e39):
        assert value_of(raw, line_probe()) is None


@given(st.text(max_size=80), st.integers(-1, 3))
def test_no_text_raises_or_gives_what_cannot_be_sent(text: str, column: int) -> None:
    part = line_probe(column=column)
    value = value_of(raw_number(text, part), part)
    assert value is None or abs(value) < 3.5e38


@pytest.mark.parametrize(
    ("table", "complaint"),
    [
        ({"name": "eleven_long", "driver": "file", "path": "x"}, "name"),
        ({"name": "a", "driver": "file"}, "path of the probe a: expected a file"),
        ({"name": "a", "driver": "serial"}, "port of the probe a: expected a device"),
        ({"name": "a", "driver": "file", "path": "x", "pattern": "("}, "pattern"),
        ({"name": "a", "driver": "file", "path": "x", "pattern": "T="}, "expected a group"),
        ({"name": "a", "driver": "file", "path": "x", "unit": "°C"}, "unit"),
    ],
)
def test_a_wrong_table_is_told(table: dict[str, object], complaint: str) -> None:
    with pytest.raises(ConfigError, match=complaint):
        decode_config({"probe": [table]}, "boat.toml")


def test_two_probes_of_one_name_are_told() -> None:
    table = {"name": "a", "driver": "file", "path": "x"}
    with pytest.raises(ConfigError, match="probe: two are named 'a'"):
        decode_config({"probe": [table, table]}, "boat.toml")


def test_probes_on_one_port_have_one_baud_rate_and_share_it_with_nothing_else() -> None:
    table = {"name": "a", "driver": "serial", "port": "/dev/ttyUSB3", "column": 0}
    boat = {
        "links": ["tcpin::5760"],
        "parts": {
            "motors": {"driver": "l298n"},
            "gnss": {"driver": "nmea", "port": "/dev/ttyUSB1"},
            "compass": {"driver": "bno055"},
        },
    }
    check_config(decode_config({**boat, "probe": [table, {**table, "name": "b"}]}, "boat.toml"))
    with pytest.raises(ConfigError, match="baud of the probe b: another on /dev/ttyUSB3 has 9600"):
        decode_config({"probe": [table, {**table, "name": "b", "baud": 4800}]}, "boat.toml")
    clash = decode_config({**boat, "probe": [{**table, "port": "/dev/ttyUSB1"}]}, "boat.toml")
    with pytest.raises(ConfigError, match=r"probe\[0\].port: /dev/ttyUSB1 belongs to parts.gnss.port"):
        check_config(clash)


# Files


@pytest.fixture
def thermometer(tmp_path: Path) -> Path:
    """A DS18B20 as w1_therm shows it."""
    folder = tmp_path / "28-0316a2795d2a"
    folder.mkdir()
    (folder / "w1_slave").write_text(W1_SLAVE.format(crc="YES", milli=23125), encoding="ascii")
    (folder / "temperature").write_text("23125\n", encoding="ascii")
    return folder


def test_a_thermometer_on_one_wire_is_read_in_degrees(thermometer: Path, clock: HandClock) -> None:
    part = ProbePart(
        name="water_t", driver="file", path=f"{thermometer.parent}/28-*/temperature", scale=0.001, unit="degC"
    )
    probe = PolledProbe(part, clock, lambda: file_number(part))
    assert probe.read() is None
    assert probe.step() == 1.0
    assert probe.read() == ProbeReading(clock(), "water_t", 23.125, "degC")


def test_a_wrong_sum_a_power_on_value_and_a_missing_part_are_no_measurements(
    thermometer: Path, clock: HandClock
) -> None:
    slave = thermometer / "w1_slave"
    part = ProbePart(
        name="water_t",
        driver="file",
        path=str(slave),
        pattern=r"YES\n.*t=(-?\d+)",
        scale=0.001,
        invalid=(85000.0,),
    )
    probe = PolledProbe(part, clock, lambda: file_number(part))
    probe.step()
    before = known(probe.read())
    assert before.value == 23.125
    for crc, milli in (("NO", 23125), ("YES", 85000)):
        slave.write_text(W1_SLAVE.format(crc=crc, milli=milli), encoding="ascii")
        with pytest.raises(HardwareError, match="no measurement"):
            probe.step()
    slave.unlink()
    with pytest.raises(FileNotFoundError):
        probe.step()
    assert probe.read() is before
    slave.write_text(W1_SLAVE.format(crc="YES", milli=-1250), encoding="ascii")
    probe.step()
    after = known(probe.read())
    assert after.value == -1.25


# Inputs


@pytest.fixture
def converter(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, clock: HandClock) -> Ads1115Twin:
    twin = Ads1115Twin(clock)
    plug_in(monkeypatch, tmp_path, {0x48: twin})
    return twin


def test_an_input_is_read_in_volts_and_scaled(converter: Ads1115Twin, clock: HandClock) -> None:
    converter.inputs_v = [0.0, 0.0, 0.0, 1.5]
    part = ProbePart(name="ph", driver="ads1115", channel=3, scale=-5.7, offset=21.34)
    chip = Ads1115(open_i2c("test"), 0x48, clock.advance)
    probe = PolledProbe(part, clock, lambda: chip.read_v(3), chip.bus.close)
    assert probe.step() == pytest.approx(1.0 - 0.036, abs=0.01)
    reading = known(probe.read())
    assert reading.value == pytest.approx(21.34 - 5.7 * 1.5, abs=0.002)
    converter.supply_v, converter.inputs_v[3] = 5.0, 5.0
    with pytest.raises(HardwareError, match="no measurement: nothing"):
        probe.step()
    probe.close()


def test_two_threads_on_one_converter_do_not_mix_their_inputs(
    converter: Ads1115Twin, clock: HandClock
) -> None:
    converter.inputs_v = [1.0, 2.0, 0.0, 0.0]
    other = Ads1115(open_i2c("test"), 0x48, clock.advance)
    seen = list[float | None]()
    thread = threading.Thread(target=lambda: seen.append(other.read_v(1)))

    def pause(seconds: float) -> None:
        """In the midst of a conversion the other thread wants one too."""
        if not thread.ident:
            thread.start()
            thread.join(timeout=0.2)
        clock.advance(seconds)

    chip = Ads1115(open_i2c("test"), 0x48, pause)
    assert chip.read_v(0) == pytest.approx(1.0, abs=0.001)
    thread.join()
    assert seen == [pytest.approx(2.0, abs=0.001)]
    chip.bus.close()
    other.bus.close()


# Lines


class Wire(MemoryLine):
    """A serial line with probes."""

    def __init__(self, clock: HandClock, *parts: ProbePart) -> None:
        super().__init__()
        self.line = SerialLine(self.port, clock, parts)

    def values_after(self, data: bytes) -> list[float | None]:
        self.say(data)
        self.line.step()
        return [None if (reading := probe.read()) is None else reading.value for probe in self.line.probes]


def test_several_probes_take_their_numbers_from_one_line(clock: HandClock) -> None:
    wire = Wire(clock, line_probe("ph", column=0), line_probe("t", column=1, offset=-1.0))
    assert wire.values_after(b"7.0") == [None, None]
    assert wire.values_after(b"1,25.5\r\n") == [7.01, 24.5]
    assert wire.values_after(b"7.02,?\r\n") == [7.02, 24.5]
    assert wire.values_after(b"ERR\r\n\xff\xfe\r\n" + 600 * b"9") == [7.02, 24.5]
    assert wire.values_after(b"\r\n7.03,26\r\n") == [7.03, 25.0]


def test_a_line_that_was_cut_by_unplugging_is_dropped(clock: HandClock) -> None:
    wire = Wire(clock, line_probe())
    wire.values_after(b"11")
    wire.far.close()
    wire.line.step()
    wire.plug_in()
    assert wire.values_after(b"22\n") == [22.0]
