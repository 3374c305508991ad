"""The state of the boat at one tick, for telemetry and logs, and what of it the failsafes look at."""

from msgspec import Struct

from companion.autopilot.pipeline import GuidancePipeline
from companion.autopilot.sensor_suite import SensorSuite
from companion.config.boat_config import BoatConfig
from companion.config.parameters import ParameterRow
from companion.core.state import MotorCommand
from companion.estimation.estimator import Estimator
from companion.failsafe.inputs import HELD_S, BoardReadings
from companion.obstacles.planning.planner import Stage
from companion.vehicle.payload_control import PayloadControl
from companion.vehicle.vehicle import Vehicle


class Snapshot(Struct, frozen=True):
    """The boat's parts, and what none of them holds. unix_s: 0 if unknown; load: share of the tick used."""

    now_s: float
    unix_s: float
    config: BoatConfig
    vehicle: Vehicle
    estimator: Estimator
    sensors: SensorSuite
    guidance: GuidancePipeline
    command: MotorCommand
    load: float
    free_memory_bytes: int  # of the computer, 0 if unknown
    payload: PayloadControl
    rows: tuple[ParameterRow, ...]  # of the boat's parameters

    @property
    def boot_ms(self) -> int:
        """Milliseconds since boot, modulo 2³²."""
        return round(self.now_s * 1e3) & 0xFFFFFFFF

    @property
    def output_us(self) -> list[int]:
        """Pulse widths of 16 outputs, 0 without one, as Rover has them: 1 left and 3 right motor; with one
        motor 1 steering and 3 throttle; with two motors and a rudder 2 steering. The payload's servos follow.
        """
        command, drive = self.command, self.config.drive
        shares: dict[int, float] = {1: command.left, 3: command.right}
        if drive.has_rudder:
            shares = {1: command.left, 2: command.rudder, 3: command.right}
            if not drive.has_pair:
                shares = {1: command.rudder, 3: command.left}
        widths_us = [0] * 16
        for channel, share in shares.items():
            widths_us[channel - 1] = round(1500.0 + 500.0 * share)
        for channel, width_us in self.payload.units.servo_us():
            widths_us[channel - 1] = width_us
        return widths_us

    @property
    def boot_us(self) -> int:
        """Microseconds since boot."""
        return round(self.now_s * 1e6)


def board_readings(
    before: BoardReadings,
    sensors: SensorSuite,
    guidance: GuidancePipeline,
    command: MotorCommand,
    *,
    is_calibrating: bool,
    is_armed: bool,
    min_depth_m: float,
    load: float,
    storage_fault: str,
) -> BoardReadings:
    """What the vehicle does not know itself, in this cycle. before: in the last."""
    gives_way = guidance.avoidance.stage in (Stage.BACK, Stage.BLOCKED)
    is_held = guidance.headway.held_s > HELD_S
    water_m = None if sensors.bottom is None else sensors.bottom.water_m
    is_deep = water_m is not None and water_m >= min_depth_m
    return BoardReadings(
        left=command.left,
        right=command.right,
        rudder=command.rudder,
        judges_motors=not (gives_way or is_held or guidance.may_touch or is_calibrating),
        stall=guidance.headway.verdict,
        held_s=guidance.headway.held_s,
        load=load,
        consumed_mah=sensors.consumed_mah,
        heading=sensors.compass,
        hull=sensors.hull,
        depth=sensors.bottom,
        escs=sensors.escs.readings,
        was_deep=is_armed and (before.was_deep or is_deep),
        has_lost_lidar=sensors.has_lidar and sensors.lidar is None,
        has_lost_sonar=sensors.has_sonar and (sensors.sonar is None or guidance.perception.is_noisy),
        storage_fault=storage_fault,
    )
