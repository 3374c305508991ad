"""Simulated receivers: from the truth to what the boat's parts would have said, by tick and seed alone.

Each sensor owns a random number generator seeded by the scenario's seed and the sensor's name, so that a
sensor more or less never shifts what another one hears. Settings are in the units of a scenario file
(degrees); everything handed on is in SI and radians.
"""

from sitl.world.sensors.battery_monitor import SimBattery
from sitl.world.sensors.compass import SimCompass
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.gnss import SimGnss
from sitl.world.sensors.hull import SimHull
from sitl.world.sensors.rc import SimRc
from sitl.world.sensors.sampling import EPOCH_UNIX_S, TIME_SLACK_S, generator
from sitl.world.sensors.settings import (
    BatteryMonitorSettings,
    CompassSettings,
    GnssSettings,
    HullSensorSettings,
    RcSettings,
    Sensors,
    SonarSettings,
    StickStep,
)
from sitl.world.sensors.sonar import SimSonar, sweep_bearings_rad

__all__ = [
    "EPOCH_UNIX_S",
    "TIME_SLACK_S",
    "BatteryMonitorSettings",
    "CompassSettings",
    "GnssSettings",
    "HullSensorSettings",
    "RcSettings",
    "SensorFault",
    "Sensors",
    "SimBattery",
    "SimCompass",
    "SimGnss",
    "SimHull",
    "SimRc",
    "SimSonar",
    "SonarSettings",
    "StickStep",
    "generator",
    "sweep_bearings_rad",
]
