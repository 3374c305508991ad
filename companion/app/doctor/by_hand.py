"""Checks by hand: the boat turned for its heading sensor; motors and rudder turned, propellers off."""

import math
from collections.abc import Callable
from contextlib import closing
from typing import Final, NamedTuple

from companion.app import parts
from companion.app.doctor.findings import Finding, failed, fine, skipped
from companion.app.doctor.parts import degrees, in_words
from companion.app.runner import Clock
from companion.config.boat_config import BoatConfig
from companion.core.errors import BoatError
from companion.core.readings import HeadingReading
from companion.core.units import wrap_pi
from companion.hal.interfaces import Compass, Motors

NAME: Final = "compass by hand"
_FRESH_S: Final = 10.0  # for a reading after each question: a BNO055 starts in 0.7 s, and must find north
_POLL_S: Final = 0.1
_OFF_RAD: Final = math.radians(30.0)  # a hand's error and iron nearby, below half a quarter turn
_TILT_RAD: Final = math.radians(10.0)  # of the 20° that are asked for


QUESTION = "The motors will turn one after the other. Are all propellers off? Type yes"
_SHARE = 0.25  # of full drive: above the deadband of brushed motors and ESCs
_TURN_S = 1.0
_PAUSE_S = 0.5
_PERIOD_S = 0.02  # of the boat's own tick; the watchdog stops motors without commands


class _Step(NamedTuple):
    """heading_rad: as it should be, None if it does not matter. tilted: the angle that should have grown."""

    question: str
    heading_rad: float | None = None
    tilted: str = ""


_STEPS: Final = (
    _Step("Level, bow to magnetic north by another compass; then Enter", heading_rad=0.0),
    _Step("Level, bow to the east; then Enter", heading_rad=0.5 * math.pi),
    _Step("Lift the bow by 20° or more; then Enter", tilted="pitch"),
    _Step("Bow down again, starboard side down by 20° or more; then Enter", tilted="roll"),
)


def turn_by_hand(
    config: BoatConfig, clock: Clock, ask: Callable[[str], str], say: Callable[[str], None]
) -> Finding:
    """Ask for four positions, and compare heading, pitch and roll in each."""
    if config.parts.compass.part_driver == "none":
        return skipped(NAME, "not fitted")
    wrong: list[str] = []
    try:
        with closing(parts.open_compass(parts.bare_compass(config), clock.now_s)) as compass:
            for step in _STEPS:
                ask(step.question)
                reading = _reading(compass, clock)
                if reading is None:
                    return failed(NAME, "no reading", "turn the boat once; check its wires")
                say(f"  {in_words(reading, config)[1]}")
                wrong += _faults(step, reading)
    except BoatError as error:
        return failed(NAME, str(error))
    if wrong:
        cure = "correct parts.compass.mounting, or imu_mounting; or keep it away from iron"
        return failed(NAME, "; ".join(wrong), cure)
    return fine(NAME, "heading, pitch and roll follow the boat")


def _reading(compass: Compass, clock: Clock) -> HeadingReading | None:
    """The first that was measured after the question."""
    began_s = clock.now_s()
    while clock.now_s() - began_s < _FRESH_S:
        reading = compass.read()
        if reading is not None and reading.time_s > began_s:
            return reading
        clock.sleep(_POLL_S)
    return None


def _faults(step: _Step, reading: HeadingReading) -> list[str]:
    if step.heading_rad is not None:
        error_rad = wrap_pi(reading.heading_rad - step.heading_rad)
        expected = degrees(step.heading_rad)
        return [f"heading {degrees(reading.heading_rad % math.tau)} instead of {expected}"] * (
            abs(error_rad) > _OFF_RAD
        )
    angles = {"roll": reading.roll_rad, "pitch": reading.pitch_rad}
    tilt_rad = angles.pop(step.tilted)
    (other_rad,) = angles.values()
    if tilt_rad is None or other_rad is None:  # a sensor that measures neither
        return []
    is_right = tilt_rad > _TILT_RAD and abs(other_rad) < tilt_rad
    return [] if is_right else [f"{step.tilted} {degrees(tilt_rad)} where it should have grown"]


def nudge_motors(
    config: BoatConfig, clock: Clock, ask: Callable[[str], str], say: Callable[[str], None]
) -> Finding:
    """Turn each motor ahead and astern, then the rudder, after a typed yes."""
    if config.parts.motors.driver == "none":
        return skipped("motors", "not fitted")
    if config.parts.motors.driver == "autopilot":
        return skipped("motors", "they turn once the autopilot is armed: use a station's motor test")
    if ask(QUESTION).strip() != "yes":
        return skipped("motors", "not turned: the answer was not yes")
    try:
        with closing(parts.open_motors(config, clock.now_s)) as motors:
            motors.start()
            if config.parts.motors.driver == "esc":
                _hold(motors, 0.0, 0.0, config.parts.motors.arming_s + _PAUSE_S, clock)
            for left, right, what in _turns(config.drive.has_pair):
                say(f"  {what}")
                _hold(motors, left, right, _TURN_S, clock)
                _hold(motors, 0.0, 0.0, _PAUSE_S, clock)
        turned_rudder = _turn_rudder(config, clock, say)
    except (BoatError, OSError) as error:
        return failed("motors", str(error))
    told = "; rudder starboard and port" if turned_rudder else ""
    text = f"each was told ahead and astern{told}"
    return fine("motors", text, "if one turned the wrong way, set left_reversed or right_reversed")


def _turns(has_pair: bool) -> list[tuple[float, float, str]]:
    if not has_pair:
        return [(_SHARE, _SHARE, "motor ahead"), (-_SHARE, -_SHARE, "motor astern")]
    return [
        (_SHARE, 0.0, "left motor ahead"),
        (-_SHARE, 0.0, "left motor astern"),
        (0.0, _SHARE, "right motor ahead"),
        (0.0, -_SHARE, "right motor astern"),
    ]


def _hold(motors: Motors, left: float, right: float, seconds: float, clock: Clock) -> None:
    end_s = clock.now_s() + seconds
    while clock.now_s() < end_s:
        motors.write(left, right)
        clock.sleep(_PERIOD_S)


def _turn_rudder(config: BoatConfig, clock: Clock, say: Callable[[str], None]) -> bool:
    if config.parts.rudder.driver == "none":
        return False
    with closing(parts.open_rudder(config, clock.now_s)) as rudder:
        for share, what in (
            (1.0, "rudder turns the bow to starboard"),
            (-1.0, "rudder to port"),
            (0.0, "amidships"),
        ):
            say(f"  {what}")
            rudder.write(share)
            clock.sleep(_TURN_S)
    return True
