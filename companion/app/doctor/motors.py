"""The motors and the rudder, turned for a moment on request, propellers off."""

from collections.abc import Callable
from contextlib import closing

from companion.app import parts
from companion.app.clock import Clock
from companion.app.doctor.findings import Finding, Verdict
from companion.config.boat_config import BoatConfig
from companion.core.errors import BoatError
from companion.hal.interfaces import Motors

QUESTION = "The motors will turn one after the other. Are all propellers off? Type yes"
_SHARE = 0.25  # of full drive: above the deadband of brushed motors and ESCs
_TURN_S = 1.0
_PAUSE_S = 0.5
_PERIOD_S = 0.02  # of the boat's own tick; the watchdog stops motors without commands


def nudge_motors(
    config: BoatConfig, clock: Clock, ask: Callable[[str], str], say: Callable[[str], None]
) -> Finding:
    """Turn each motor ahead and astern, then the rudder, after a typed yes."""
    if config.parts.motors.driver == "none":
        return Finding("motors", Verdict.SKIPPED, "not fitted")
    if ask(QUESTION).strip() != "yes":
        return Finding("motors", Verdict.SKIPPED, "not turned: the answer was not yes")
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
        return Finding("motors", Verdict.FAILED, str(error))
    told = "; rudder starboard and port" if turned_rudder else ""
    text = f"each was told ahead and astern{told}"
    return Finding(
        "motors", Verdict.FINE, text, "if one turned the wrong way, set left_reversed or right_reversed"
    )


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
    with closing(parts.open_rudder(config)) as rudder:
        for share, what in (
            (1.0, "rudder turns the bow to starboard"),
            (-1.0, "rudder to port"),
            (0.0, "amidships"),
        ):
            say(f"  {what}")
            rudder.write(share)
            clock.sleep(_TURN_S)
    return True
