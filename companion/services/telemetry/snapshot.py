"""The state of the boat at one tick, for telemetry and logs."""

from msgspec import Struct

from companion.config.boat_config import BoatConfig
from companion.core.state import MotorCommand
from companion.guidance.pipeline import GuidancePipeline
from companion.payload.control import PayloadControl
from companion.sensors.suite import SensorSuite
from companion.vehicle.vehicle import Vehicle


class Snapshot(Struct, frozen=True):
    """The parts of the boat, and what they do not hold. unix_s is 0 if the date is unknown; load is the share
    of the tick used.
    """

    now_s: float
    unix_s: float
    config: BoatConfig
    vehicle: Vehicle
    sensors: SensorSuite
    guidance: GuidancePipeline
    command: MotorCommand
    load: float
    free_memory_bytes: int  # of the computer, 0 if unknown
    payload: PayloadControl

    @property
    def boot_ms(self) -> int:
        """Milliseconds since boot, modulo 2³²."""
        return round(self.now_s * 1e3) & 0xFFFFFFFF

    @property
    def boot_us(self) -> int:
        """Microseconds since boot."""
        return round(self.now_s * 1e6)
