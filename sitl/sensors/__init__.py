"""Simulated receivers: from the truth to what the boat's parts would have said, by tick and seed alone.

Each sensor owns a random number generator seeded by the scenario's seed and the sensor's name, so that a
sensor more or less never shifts what another one hears. Settings are in the units of a scenario file
(degrees); everything handed on is in SI and radians.
"""

from companion.section import Section
from sitl.sensors.battery_monitor import BatteryMonitorSettings, SimBattery
from sitl.sensors.compass import CompassSettings, SimCompass
from sitl.sensors.fault import SensorFault
from sitl.sensors.gnss import GnssSettings, SimGnss
from sitl.sensors.sampling import EPOCH_UNIX_S, TIME_SLACK_S, generator
from sitl.sensors.sonar import SimSonar, SonarSettings, sweep_bearings_rad

__all__ = [
    "EPOCH_UNIX_S",
    "TIME_SLACK_S",
    "BatteryMonitorSettings",
    "CompassSettings",
    "GnssSettings",
    "SensorFault",
    "Sensors",
    "SimBattery",
    "SimCompass",
    "SimGnss",
    "SimSonar",
    "SonarSettings",
    "generator",
    "sweep_bearings_rad",
]


class Sensors(Section, frozen=True):
    """The sensors aboard."""

    gnss: GnssSettings = GnssSettings()
    compass: CompassSettings = CompassSettings()
    sonar: SonarSettings = SonarSettings()
    battery: BatteryMonitorSettings = BatteryMonitorSettings()
