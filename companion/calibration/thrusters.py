"""Thruster calibration: pulses at rest, runs at full throttle and cruise speed, and hard turns."""

import math
from typing import Final

from msgspec.structs import replace

from companion.calibration import pulses, runs
from companion.calibration.routine import (
    CalibrationError,
    Routine,
    RoutineInputs,
    Step,
    TrialFinding,
    come_back,
)
from companion.config.actuators import Thrusters
from companion.config.boat_config import BoatConfig
from companion.control.allocation import from_pwm, motor_pwm
from companion.core.intent import Drive
from companion.core.state import HEALTHY_MOTORS, MotorCommand
from companion.core.units import clamp

_FULL: Final = 3.0  # times the known top speed: demands full throttle of any boat
_SHORT: Final = 0.9  # of cruise speed: below, the boat does not reach it
_BANDS: Final = (
    ("MOT_L_MIN_FWD", "left_ahead", pulses.LEFT_AHEAD),
    ("MOT_L_MIN_REV", "left_astern", pulses.LEFT_ASTERN),
    ("MOT_R_MIN_FWD", "right_ahead", pulses.RIGHT_AHEAD),
    ("MOT_R_MIN_REV", "right_astern", pulses.RIGHT_ASTERN),
)
_MOST_DEAD: Final = 0.5
_LEAST_GAIN: Final = 0.25


def calibrate(inputs: RoutineInputs) -> Routine:
    """The whole calibration. The motors must be driven without trim meanwhile."""
    test = pulses.PulseTest()
    yield from test.sail(inputs)
    curves = {one: test.curve(one) for _, _, one in _BANDS}
    setting = inputs.config.thrusters
    findings = []
    for name, field, one in _BANDS:
        curve = curves[one]
        if curve is not None:
            band = min(curve.dead_band, _MOST_DEAD)
            setting = replace(setting, **{field: band})
            findings.append(TrialFinding(name, 100.0 * band))
    left, left_astern, right, right_astern = curves.values()  # as in _BANDS
    asymmetry = _asymmetry([(left, left_astern), (right, right_astern)])
    if asymmetry is not None:
        setting = replace(setting, asymmetry=asymmetry)
        findings.append(TrialFinding("MOT_THST_ASYM", asymmetry))

    yield from come_back(inputs)
    heading, config = inputs.nav.heading_rad, inputs.config
    full = yield from _out_and_back(inputs, heading, _FULL * config.handling.top_speed_m_s)
    cruising = yield from _out_and_back(inputs, heading, config.speed.cruise_m_s)
    setting = _balanced(setting, (full, cruising))
    findings += [
        TrialFinding("MOT_L_GAIN", setting.left_gain),
        TrialFinding("MOT_R_GAIN", setting.right_gain),
        *_speeds(setting, full, cruising, config),
    ]

    rates = []
    for side in (1.0, -1.0):
        yield from runs.go_to_edge(inputs, heading)
        drive = _steered(setting, side * config.heading.max_steering)
        rates.append((yield from runs.hard_turn_rad_s(inputs, heading, drive)))
    findings.append(TrialFinding("HND_TURN_RATE", math.degrees(0.5 * (rates[0] + rates[1]))))
    yield from come_back(inputs)
    return findings


def _out_and_back(inputs: RoutineInputs, heading_rad: float, speed_m_s: float) -> Step[runs.RunPair]:
    sailed: list[runs.Run] = []
    for course in (heading_rad, runs.opposite(heading_rad)):
        for _ in range(runs.TRIES):
            yield from runs.go_to_edge(inputs, course)
            if (run := (yield from runs.sail_run(inputs, course, speed_m_s))) is not None:
                sailed.append(run)
                break
        else:
            raise CalibrationError("something is in the way of every run")
    return runs.RunPair(*sailed)


def _asymmetry(sides: list[tuple[pulses.ThrustCurve | None, pulses.ThrustCurve | None]]) -> float | None:
    """Ratio of the commands astern and ahead for equal thrust, without the dead bands; mean of both sides."""
    ratios = []
    for ahead, astern in sides:
        if ahead is not None and astern is not None:
            root = min(ahead.root_max, astern.root_max)
            ratios.append(astern.over(root) / ahead.over(root))
    return clamp(sum(ratios) / len(ratios), 1.0, 10.0) if ratios else None


def _balanced(setting: Thrusters, pairs: tuple[runs.RunPair, runs.RunPair]) -> Thrusters:
    """Add the gains of left and right with which the boat went straight."""
    ratios = []
    for pair in pairs:
        left = from_pwm(pair.left, setting.left_ahead, 1.0)
        right = from_pwm(pair.right, setting.right_ahead, 1.0)
        if not (left > 0.0 and right > 0.0):
            raise CalibrationError("one motor gives no thrust")
        ratios.append(left / right)
    ratio = sum(ratios) / len(ratios)
    if not _LEAST_GAIN <= ratio <= 1.0 / _LEAST_GAIN:
        raise CalibrationError("the motors are too unequal")
    return replace(setting, left_gain=min(ratio, 1.0), right_gain=min(1.0 / ratio, 1.0))


def _speeds(
    setting: Thrusters, full: runs.RunPair, cruising: runs.RunPair, config: BoatConfig
) -> list[TrialFinding]:
    findings, cruise_m_s, top_m_s = [], config.speed.cruise_m_s, full.speed_m_s
    if full.is_steady:
        findings.append(TrialFinding("HND_TOP_SPEED", top_m_s))
    if cruising.speed_m_s < _SHORT * cruise_m_s:
        return findings
    throttle = 0.5 * (
        from_pwm(cruising.left, setting.left_ahead, setting.left_gain)
        + from_pwm(cruising.right, setting.right_ahead, setting.right_gain)
    )
    throttle = min(throttle * cruise_m_s / cruising.speed_m_s, 1.0)
    findings.append(TrialFinding("CRUISE_THROTTLE", 100.0 * throttle))
    if full.is_steady:
        findings.append(
            TrialFinding("EST_SURGE_TIME", runs.surge_time_s(full, top_m_s, cruise_m_s, throttle))
        )
    return findings


def _steered(setting: Thrusters, steering: float) -> Drive:
    """The untrimmed command for pure steering."""
    left, right = motor_pwm(MotorCommand(steering, -steering), HEALTHY_MOTORS, setting)
    return Drive(0.5 * (left + right), 0.5 * (left - right))
