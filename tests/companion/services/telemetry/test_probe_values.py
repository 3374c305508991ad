"""Probes on a whole boat: sent at their rates, silent ones told once, logged with the place."""

import dataclasses
import math
from pathlib import Path

import pytest
from boat_rig import Rig, waypoint
from log_rig import LogRig, of_kind, read_log
from msgspec.structs import replace

from companion.boat import Boat
from companion.config.sensors import ProbePart
from companion.core.readings import ProbeReading


class FakeProbe:
    """A probe that measures at a period of its own."""

    def __init__(self, name: str, value: float, unit: str = "", period_s: float = 0.1) -> None:
        self._name, self.value, self._unit = name, value, unit
        self._period_s = period_s
        self._looks = 0
        self.is_silent = False
        self._latest: ProbeReading | None = None

    def read(self) -> ProbeReading | None:
        time_s = 0.1 * self._looks
        self._looks += 1
        if not self.is_silent and (self._latest is None or time_s - self._latest.time_s >= self._period_s):
            self._latest = ProbeReading(time_s, self._name, self.value, self._unit)
        return self._latest

    def close(self) -> None:
        """Nothing to let go."""


def setting(name: str, rate_hz: float) -> ProbePart:
    return ProbePart(name=name, driver="file", path="x", rate_hz=rate_hz)


PARTS = (setting("turbidity", 2.0), setting("ph", 0.5), setting("abcdefghij", 10.0))


class ProbeRig(Rig):
    """A boat with three probes."""

    def __init__(self) -> None:
        self.turbidity, self.ph = FakeProbe("turbidity", 3.5, "NTU"), FakeProbe("ph", 7.0)
        self.slow = FakeProbe("abcdefghij", 1.0, period_s=3.0)
        super().__init__(probes=(self.turbidity, self.ph, self.slow))

    def _build(self) -> Boat:
        self.config = replace(self.config, probe=PARTS)
        return super()._build()

    def values(self, name: str) -> list[float]:
        said = self.peer.said("NAMED_VALUE_FLOAT")
        return [one.value for one in said if one.name.rstrip("\0") == name]


def test_each_probe_is_sent_at_its_rate_and_no_value_twice() -> None:
    rig = ProbeRig()
    rig.run(2.0)
    rig.peer.forget()
    rig.run(12.0)
    assert len(rig.values("turbidity")) == pytest.approx(24, abs=1)
    assert len(rig.values("ph")) == pytest.approx(6, abs=1)
    assert len(rig.values("abcdefghij")) == pytest.approx(4, abs=1)
    assert set(rig.values("turbidity")) == {3.5}
    message = rig.peer.said("NAMED_VALUE_FLOAT")[-1]
    assert message.time_boot_ms == pytest.approx(1e3 * rig.now_s, abs=3000)


def test_a_silent_probe_is_told_once_and_not_sent_and_comes_back() -> None:
    rig = ProbeRig()
    rig.run(2.0)
    rig.ph.is_silent = True
    rig.run(12.0)
    rig.peer.forget()
    rig.run(3.0)
    assert rig.values("ph") == []
    assert rig.values("turbidity")
    assert not any("ph" in text for text in rig.peer.texts), "told before"
    rig.ph.is_silent = False
    rig.run(3.0)
    assert rig.peer.texts.count("Probe ph measures again") == 1
    assert rig.values("ph")
    assert not any(math.isnan(value) for value in rig.values("ph"))


class LoggedRig(LogRig):
    """A boat with one probe that writes logs."""

    def _build(self) -> Boat:
        self.config = replace(self.config, probe=PARTS[:1])
        self.hardware = dataclasses.replace(self.hardware, probes=(FakeProbe("turbidity", 3.5, "NTU", 1.0),))
        return super()._build()


def test_values_are_logged_with_name_unit_and_place(tmp_path: Path) -> None:
    rig = LoggedRig(tmp_path)
    rig.sail(waypoint(600.0, 0.0))
    rig.run(5.0)
    rig.disarm()
    (log,) = tmp_path.glob("*.bin")
    records = of_kind(read_log(log), "PROB")
    assert len(records) == pytest.approx(15, abs=4)
    assert {(record.Name, record.Unit, record.Value) for record in records} == {("turbidity", "NTU", 3.5)}
    assert records[-1].Lat - records[0].Lat > 4.0 / 111e3
