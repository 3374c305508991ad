"""What the failsafes look at, as far as the vehicle does not know it itself."""

from companion.autopilot.pipeline import GuidancePipeline
from companion.autopilot.sensor_suite import SensorSuite
from companion.core.state import MotorCommand
from companion.failsafe.guards import HELD_S
from companion.failsafe.inputs import BoardReadings
from companion.obstacles.planning.planner import Stage


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
    """The readings of this cycle. before: those of the last."""
    gives_way = guidance.avoidance.stage in (Stage.BACK, Stage.BLOCKED)
    is_held = guidance.headway.held_s > HELD_S
    water_m = None if sensors.bottom is None else sensors.bottom.water_m
    is_deep = water_m is not None and water_m >= min_depth_m
    return BoardReadings(
        left=command.left,
        right=command.right,
        rudder=command.rudder,
        judges_motors=not (gives_way or is_held or is_calibrating),
        stall=guidance.headway.verdict,
        held_s=guidance.headway.held_s,
        load=load,
        consumed_mah=sensors.consumed_mah,
        heading=sensors.compass,
        hull=sensors.hull,
        depth=sensors.bottom,
        was_deep=is_armed and (before.was_deep or is_deep),
        has_lost_sonar=sensors.has_sonar and (sensors.sonar is None or guidance.perception.is_noisy),
        storage_fault=storage_fault,
    )
