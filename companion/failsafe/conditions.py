"""The conditions of the failsafes: each says in a few words what is wrong, "" while nothing is."""

import math
from typing import Final

from companion.core.modes import Mode
from companion.core.state import (
    COMPASS_FAULTS,
    GNSS_FAULTS,
    EstimateFault,
    fault_texts,
    lacks_heading,
    lacks_position,
)
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.motors.hypotheses import Fault
from companion.guidance.stall_detector import StallVerdict

_RC_EXCEPT_AUTO: Final = 2  # FS_THR_ENABLE: a mission goes on without a transmitter
# Plain numbers: an IntFlag's arithmetic costs microseconds
_GYRO: Final = int(EstimateFault.GYRO_LOST | EstimateFault.GYRO_OFF)


# Position and heading


def position_lost(inputs: FailsafeInputs) -> str:
    """The position is too uncertain to sail by."""
    nav, timeout_s = inputs.nav, inputs.config.motors.estimate_timeout_s
    return "Position lost" if nav is not None and lacks_position(nav, timeout_s) else ""


def heading_lost(inputs: FailsafeInputs) -> str:
    """The heading is too uncertain to steer by."""
    nav, timeout_s = inputs.nav, inputs.config.motors.estimate_timeout_s
    return "Heading lost" if nav is not None and lacks_heading(nav, timeout_s) else ""


def gnss_bad(inputs: FailsafeInputs) -> str:
    """The receiver is silent, late, frozen or jumping."""
    return _worst(inputs, GNSS_FAULTS)


def compass_bad(inputs: FailsafeInputs) -> str:
    """The compass is silent, late, frozen, or disagrees with the course."""
    return _worst(inputs, COMPASS_FAULTS)


def gyro_bad(inputs: FailsafeInputs) -> str:
    """The gyro is silent, stuck, erratic or biased while the compass measures."""
    return _worst(inputs, _GYRO)


def _worst(inputs: FailsafeInputs, of: int) -> str:
    nav = inputs.nav
    return "" if nav is None or not nav.faults & of else fault_texts(nav.faults & of)[0]


# Power


def battery_low(inputs: FailsafeInputs) -> str:
    """Below BATT_LOW_VOLT."""
    return _below(inputs, inputs.config.failsafe.battery_low_v, "low")


def battery_critical(inputs: FailsafeInputs) -> str:
    """Below BATT_CRT_VOLT."""
    return _below(inputs, inputs.config.failsafe.battery_critical_v, "critical")


def _below(inputs: FailsafeInputs, limit_v: float, what: str) -> str:
    battery = inputs.battery
    if battery is None or limit_v <= 0.0 or not battery.voltage_v < limit_v:
        return ""
    return f"Battery {what}: {battery.voltage_v:.1f} V"


def out_of_range(inputs: FailsafeInputs) -> str:
    """The charge will soon no longer take the boat home."""
    return inputs.range_fault


# Propulsion


def motor_failing(inputs: FailsafeInputs) -> str:
    """A motor gives no thrust, or too little for its current."""
    verdict = inputs.verdict
    inferred = "" if verdict is None or verdict.fault is Fault.REVERSED else verdict.text
    return inputs.failed_motor or inferred


def steering_lost(inputs: FailsafeInputs) -> str:
    """A motor turns the wrong way, or the rudder has no effect."""
    verdict = inputs.verdict
    if inputs.rudder_fault:
        return inputs.rudder_fault
    return verdict.text if verdict is not None and verdict.fault is Fault.REVERSED else ""


def no_headway(inputs: FailsafeInputs) -> str:
    """Full ahead, and the current is as fast as the boat."""
    is_stalled = inputs.board.stall is StallVerdict.NO_HEADWAY
    return "No headway: current as fast as the boat" if is_stalled else ""


def stuck(inputs: FailsafeInputs) -> str:
    """Full ahead, and something holds the boat."""
    if inputs.board.stall is not StallVerdict.STUCK:
        return ""
    has_pair = inputs.config.drive.has_pair
    return "Stuck: something holds the boat" if has_pair else "Stuck: held, or the motor gives no thrust"


# Boundary


def aground(inputs: FailsafeInputs) -> str:
    """Close to a line of the fence or a shore that was seen, driven hard, and held."""
    return "Aground: held at the shore" if inputs.board.stall is StallVerdict.AGROUND else ""


def shallow(inputs: FailsafeInputs) -> str:
    """Less deep than FS_DEPTH_MIN. A boat that starts from the beach is watched once it has been deeper."""
    depth = inputs.board.depth
    water_m = None if depth is None else depth.water_m
    is_shallow = (
        water_m is not None and inputs.board.was_deep and water_m < inputs.config.failsafe.min_depth_m
    )
    return f"Shallow: {water_m:.1f} m" if is_shallow else ""


def fence_breached(inputs: FailsafeInputs) -> str:
    """Beyond a line of the fence."""
    beyond_m = inputs.beyond_fence_m
    return f"Outside the fence by {beyond_m:.1f} m" if beyond_m > 0.0 else ""


# Hull


def capsized(inputs: FailsafeInputs) -> str:
    """Keel up, or nearly, by a heading sensor that gives roll and pitch."""
    reading, limit_rad = inputs.board.heading, inputs.config.failsafe.capsize_rad
    if reading is None or limit_rad <= 0.0 or reading.roll_rad is None or reading.pitch_rad is None:
        return ""
    if not max(abs(reading.roll_rad), abs(reading.pitch_rad)) > limit_rad:
        return ""
    return f"Capsized: roll {math.degrees(reading.roll_rad):.0f}, pitch {math.degrees(reading.pitch_rad):.0f}"


def leak(inputs: FailsafeInputs) -> str:
    """Water in the hull."""
    reading = inputs.board.hull
    return "Water in the hull" if reading is not None and reading.is_wet else ""


def too_hot(inputs: FailsafeInputs) -> str:
    """Hull or computer above FS_TEMP_MAX."""
    reading, limit_c = inputs.board.hull, inputs.config.failsafe.max_temperature_c
    if reading is None or reading.temperature_c is None or limit_c <= 0.0:
        return ""
    return f"Too hot: {reading.temperature_c:.0f} C" if reading.temperature_c > limit_c else ""


# Links


def operator_lost(inputs: FailsafeInputs) -> str:
    """The operator's heartbeats have stopped."""
    setting = inputs.config.failsafe
    is_lost = setting.gcs_enabled and inputs.operator_silent_s > setting.gcs_timeout_s
    return f"Operator lost for {setting.gcs_timeout_s:g} s" if is_lost else ""


def planner_lost(inputs: FailsafeInputs) -> str:
    """The program that steers in GUIDED, or in a mission's hand-over, is silent."""
    limit_s = inputs.config.failsafe.planner_timeout_s
    is_lost = limit_s > 0.0 and inputs.planner_silent_s > limit_s
    return f"Planner lost for {limit_s:g} s" if is_lost else ""


def helm_lost(inputs: FailsafeInputs) -> str:
    """A station's sticks that steered the boat are stale."""
    is_lost = inputs.config.failsafe.rc_enabled and inputs.sticks_dropped and not inputs.radio_heard
    return "RC lost: no stick input" if is_lost else ""


def rc_lost(inputs: FailsafeInputs) -> str:
    """The transmitter is gone, and no station steers in its place."""
    enabled = inputs.config.failsafe.rc_enabled
    if not inputs.radio_heard or not enabled or (enabled == _RC_EXCEPT_AUTO and inputs.mode is Mode.AUTO):
        return ""
    return f"RC lost: {inputs.radio_fault}" if inputs.radio_fault and not inputs.has_station_sticks else ""


# Computer


def sonar_lost(inputs: FailsafeInputs) -> str:
    """A sonar that has pinged is silent, or its ranges jump at random; or a lidar that has is silent."""
    limit_s, board = inputs.config.failsafe.sonar_timeout_s, inputs.board
    name = "Lidar" if board.has_lost_lidar else "Sonar" if board.has_lost_sonar else ""
    return f"{name} lost for {limit_s:g} s" if name else ""


def overrun(inputs: FailsafeInputs) -> str:
    """The control loop takes longer than its tick."""
    load = inputs.board.load
    return f"Computer overloaded: load {100.0 * load:.0f} %" if load > 1.0 else ""


def storage_failed(inputs: FailsafeInputs) -> str:
    """Data that must survive a restart could not be written."""
    fault = inputs.board.storage_fault
    return f"Storage failed: {fault}" if fault else ""
