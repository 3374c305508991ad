"""The doctor's readings through the boat's own drivers, over twins of the parts."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import reduce
from operator import xor
from pathlib import Path

import pytest
from doctor_tree import Examine
from twins.battery import Ina219Twin
from twins.i2c import Bno055Twin, plug_in
from twins.lines import PtyLine

from companion.app.doctor.findings import Verdict
from companion.app.doctor.parts import part_findings
from companion.app.runner import SystemClock
from companion.config.boat_config import BoatConfig, Parts
from companion.config.sensors import BatteryPart, CompassPart, GnssPart

pytest_plugins = ("doctor_fixtures",)

FIX = (
    "GNRMC,092750.00,A,5030.0,N,00112.0,W,0.0,90.0,280524,,,A",
    "GNGGA,092750.00,5030.0,N,00112.0,W,1,09,0.9,5.0,M,47.0,M,,",
)


@contextmanager
def speaking(line: PtyLine) -> Iterator[None]:
    """A receiver that repeats its fix until it is unplugged."""
    is_over = threading.Event()
    said = "".join(f"${body}*{reduce(xor, body.encode()):02X}\r\n" for body in FIX).encode()

    def speak() -> None:
        while not is_over.wait(0.02):
            line.say(said)

    thread = threading.Thread(target=speak)
    thread.start()
    try:
        yield
    finally:
        is_over.set()
        thread.join()
        line.unplug()


def test_each_part_is_opened_read_and_released(
    examine: Examine, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    clock = SystemClock()
    plug_in(monkeypatch, tmp_path, {0x28: Bno055Twin(), 0x40: Ina219Twin(clock.now_s)})
    line = PtyLine(tmp_path / "gnss")
    parts = Parts(
        gnss=GnssPart(driver="nmea", port=line.device),
        compass=CompassPart(driver="bno055"),
        battery=BatteryPart(driver="ina219"),
    )
    before = threading.active_count()
    with speaking(line):
        findings = part_findings(examine({}, BoatConfig(parts=parts)), clock)
        told = {one.name: (one.verdict, one.text) for one in findings if one.verdict is not Verdict.SKIPPED}
    assert threading.active_count() == before, "a driver's thread is left"
    place = "3-D fix, 9 satellites, HDOP 0.9, 50.500000 -1.200000"
    assert told["gnss"] == (Verdict.FINE, f"nmea: {place}")
    assert told["compass"][0] is Verdict.FINE
    assert told["compass"][1].startswith("bno055: heading ")
    assert told["battery"][1].startswith("ina219: ")
    assert " V" in told["battery"][1]
    assert set(told) == {"gnss", "compass", "battery"}
