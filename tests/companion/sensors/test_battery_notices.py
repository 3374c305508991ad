"""What the operator is told of the battery monitor: a wrong number of cells, silence and its end."""

import pytest
from boat_rig import FakeBattery, Rig

from companion.core.readings import BatteryReading
from companion.core.status_text import Severity
from companion.mavlink.dialect import dialect
from companion.sensors.charge import cells_fault
from companion.sensors.silence import SilenceMonitor


@pytest.mark.parametrize(
    ("voltage_v", "cells", "text"),
    [
        (11.1, 3, ""),
        (9.61, 3, ""),
        (12.74, 3, ""),
        (9.59, 3, "Battery: 9.6 V does not fit 3 cells"),
        (12.76, 3, "Battery: 12.8 V does not fit 3 cells"),
        (14.8, 3, "Battery: 14.8 V does not fit 3 cells, but 4"),
        (11.1, 4, "Battery: 11.1 V does not fit 4 cells, but 3"),
        (24.8, 4, "Battery: 24.8 V does not fit 4 cells, but 7"),
        (0.0, 3, "Battery: 0.0 V does not fit 3 cells"),
    ],
)
def test_a_resting_pack_says_whether_its_cells_are_configured_rightly(
    voltage_v: float, cells: int, text: str
) -> None:
    assert cells_fault(voltage_v, cells) == text


def test_the_operator_is_warned_of_a_wrong_number_of_cells_once() -> None:
    rig = Rig(battery=FakeBattery(14.8))
    rig.run(10.0)
    assert rig.peer.texts.count("Battery: 14.8 V does not fit 3 cells, but 4") == 1


class Stopping(FakeBattery):
    """A monitor that can fall silent."""

    is_silent = False
    last: BatteryReading | None = None

    def read(self) -> BatteryReading:
        reading = super().read()
        if not self.is_silent or self.last is None:
            self.last = reading
        return self.last


def test_a_silent_monitor_is_told_and_its_last_values_are_not_sent_as_present_ones() -> None:
    battery = Stopping(12.0)
    rig = Rig(battery=battery)
    rig.run(5.0)
    assert rig.peer.said("SYS_STATUS")[-1].voltage_battery == 12000
    assert rig.peer.said("BATTERY_STATUS")[-1].time_remaining > 3600
    battery.is_silent = True
    rig.run(2.9)
    assert "Battery monitor is silent" not in rig.peer.texts
    rig.run(5.0)
    assert rig.peer.texts.count("Battery monitor is silent") == 1
    status, pack = rig.peer.said("SYS_STATUS")[-1], rig.peer.said("BATTERY_STATUS")[-1]
    assert (status.voltage_battery, status.current_battery) == (0xFFFF, -1)
    bit = dialect.MAV_SYS_STATUS_SENSOR_BATTERY
    assert status.onboard_control_sensors_present & bit
    assert not status.onboard_control_sensors_health & bit
    assert (pack.voltages[0], pack.current_battery, pack.time_remaining) == (0xFFFF, -1, 0)
    assert pack.charge_state == dialect.MAV_BATTERY_CHARGE_STATE_UNDEFINED
    battery.is_silent = False
    rig.run(3.0)
    assert rig.peer.texts.count("Battery monitor measures again") == 1
    assert rig.peer.said("SYS_STATUS")[-1].voltage_battery == 12000


def test_a_part_that_never_measured_is_silent_from_the_timeout_on() -> None:
    monitor = SilenceMonitor("Probe")
    assert monitor.update(3.0, 100.0, is_heard=False) is None
    assert monitor.update(3.0, 103.0, is_heard=False) is None
    assert monitor.update(3.0, 103.1, is_heard=False) == (Severity.WARNING, "Probe is silent")
    assert monitor.update(3.0, 200.0, is_heard=False) is None
    assert monitor.update(3.0, 200.1, is_heard=True) == (Severity.NOTICE, "Probe measures again")
    assert monitor.update(3.0, 203.0, is_heard=True) is None
    assert monitor.update(3.0, 203.1, is_heard=False) == (Severity.WARNING, "Probe is silent")


class Late:
    """A part that is missing at first."""

    is_open = False


def test_a_missing_part_is_not_silent_until_it_has_been_opened() -> None:
    part = Late()
    monitor = SilenceMonitor("Probe", part)
    assert [monitor.update(3.0, 0.1 * tick, is_heard=False) for tick in range(100)] == [None] * 100
    part.is_open = True
    assert [monitor.update(3.0, 10.0 + 0.1 * tick, is_heard=False) for tick in range(31)] == [None] * 31
    assert monitor.update(3.0, 13.2, is_heard=False) == (Severity.WARNING, "Probe is silent")
