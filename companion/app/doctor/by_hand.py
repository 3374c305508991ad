"""The heading sensor, with the boat turned by hand: does it point ahead, and which way are roll and pitch?"""

import math
from collections.abc import Callable
from contextlib import closing
from typing import Final, NamedTuple

from companion.app import parts
from companion.app.clock import Clock
from companion.app.doctor.findings import Finding, Verdict
from companion.config.boat_config import BoatConfig
from companion.core.errors import BoatError
from companion.core.readings import HeadingReading
from companion.core.units import wrap_pi
from companion.hal.interfaces import Compass

NAME: Final = "compass by hand"
_FRESH_S: Final = 10.0  # for a reading after each question: a BNO055 starts in 0.7 s, and must find north
_POLL_S: Final = 0.1
_OFF_RAD: Final = math.radians(30.0)  # a hand's error and iron nearby, below half a quarter turn
_TILT_RAD: Final = math.radians(10.0)  # of the 20° that are asked for


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
        return Finding(NAME, Verdict.SKIPPED, "not fitted")
    wrong: list[str] = []
    try:
        with closing(parts.open_compass(parts.bare_compass(config), clock.now_s)) as compass:
            for step in _STEPS:
                ask(step.question)
                reading = _reading(compass, clock)
                if reading is None:
                    return Finding(NAME, Verdict.FAILED, "no reading", "turn the boat once; check its wires")
                say(f"  {_words(reading)}")
                wrong += _faults(step, reading)
    except BoatError as error:
        return Finding(NAME, Verdict.FAILED, str(error))
    if wrong:
        cure = "correct parts.compass.mounting, or imu_mounting; or keep it away from iron"
        return Finding(NAME, Verdict.FAILED, "; ".join(wrong), cure)
    return Finding(NAME, Verdict.FINE, "heading, pitch and roll follow the boat")


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
        expected = f"{math.degrees(step.heading_rad):.0f}°"
        return [f"heading {_degrees(reading.heading_rad % math.tau)} instead of {expected}"] * (
            abs(error_rad) > _OFF_RAD
        )
    angles = {"roll": reading.roll_rad, "pitch": reading.pitch_rad}
    tilt_rad = angles.pop(step.tilted)
    (other_rad,) = angles.values()
    if tilt_rad is None or other_rad is None:  # a sensor that measures neither
        return []
    is_right = tilt_rad > _TILT_RAD and abs(other_rad) < tilt_rad
    return [] if is_right else [f"{step.tilted} {_degrees(tilt_rad)} where it should have grown"]


def _words(reading: HeadingReading) -> str:
    text = f"heading {_degrees(reading.heading_rad % math.tau)}"
    if reading.roll_rad is None or reading.pitch_rad is None:
        return text
    return f"{text}, pitch {_degrees(reading.pitch_rad)}, roll {_degrees(reading.roll_rad)}"


def _degrees(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad):.0f}°"
