"""All that the failsafes look at."""

import math

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.modes import Mode
from companion.core.state import NavState
from companion.failsafe.power import Endurance
from companion.failsafe.propulsion import MotorWatch
from companion.failsafe.stations import Operator, Planner
from companion.geofence.monitor import FenceMonitor
from companion.rc.manual_input import ManualInput
from companion.sensors.readings import BatteryReading, GnssFix, HeadingReading, HullReading


class FailsafeInputs:
    """The vehicle and the boat write them, ten times a second is enough; the watches read them.

    headway: guidance's verdict, 1 the water is as fast as the boat, 2 something holds it, 3 the shore does.
    sonar_s: when the latest ping came, NaN where there is no sonar. storage_fault: why something could not
    be written, "".
    """

    __slots__ = (
        "armed",
        "battery",
        "config",
        "consumed_mah",
        "endurance",
        "failed_motor",
        "failed_motor",
        "fence",
        "fix",
        "gives_way",
        "heading",
        "headway",
        "home",
        "home_distance_m",
        "hull",
        "is_guided",
        "left",
        "load",
        "mode",
        "motors",
        "nav",
        "now_s",
        "operator",
        "planner",
        "right",
        "shortfall",
        "sonar_s",
        "sticks",
        "storage_fault",
    )

    def __init__(self, config: BoatConfig, sticks: ManualInput) -> None:
        self.config = config
        self.sticks = sticks
        self.operator = Operator()
        self.planner = Planner()
        self.endurance = Endurance()
        self.motors = MotorWatch(config)
        self.fence = FenceMonitor()
        self.now_s = 0.0
        self.mode = Mode.HOLD
        self.armed = False
        self.is_guided = False
        self.failed_motor = ""  # the motor that did not pull in a motor check
        self.nav: NavState | None = None
        self.fix: GnssFix | None = None
        self.battery: BatteryReading | None = None
        self.home: Point | None = None
        self.home_distance_m = math.inf  # by the water; infinite while no way is known
        self.shortfall = ""  # of charge for the way home, in words
        self.heading: HeadingReading | None = None  # as the part gave it
        self.hull: HullReading | None = None
        self.consumed_mah = 0.0
        self.gives_way = False  # motors are not judged: at an obstacle, or in a calibration trial
        self.left = self.right = 0.0  # what the motors are given
        self.headway = 0
        self.load = 0.0
        self.sonar_s = math.nan
        self.storage_fault = ""
