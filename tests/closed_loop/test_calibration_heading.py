"""The heading's autotune, from gains that are a third of the usual ones, on both boats."""

import math
from typing import NamedTuple

from boat_rig import OK, Rig

from companion.config.boat_config import BoatConfig
from companion.core.intent import HoldHeading
from companion.core.modes import Mode
from companion.core.requests import SetPoint
from companion.core.units import wrap_pi
from companion.mavlink.dialect import dialect

AUTOTUNE, IN_PROGRESS = dialect.MAV_CMD_DO_AUTOTUNE_ENABLE, 5
STEP_RAD = math.radians(30.0)
WATER = {
    "lake": ("environment.wind_m_s=3.0", "environment.current_m_s=0.3"),
    "pool": ("environment.wind_m_s=0.0", "environment.current_m_s=0.005"),
}


class StepResponse(NamedTuple):
    """To a step of the heading at cruise speed: shares of the step, and seconds."""

    overshoot: float
    error_s: float  # the integral of what is left
    settled_s: float  # within a tenth for good


def third(model: str) -> dict[str, object]:
    heading = Rig("open", f"boat.model='{model}'").config.heading
    return {f"heading.{name}": getattr(heading, name) / 3.0 for name in ("kp", "ki", "kd")}


def gains_of(config: BoatConfig) -> dict[str, object]:
    return {f"heading.{name}": getattr(config.heading, name) for name in ("kp", "ki", "kd")}


def afloat(model: str, config: dict[str, object], seed: int) -> Rig:
    settings = (f"boat.model='{model}'", f"seed={seed}", "sensors.sonar.fitted=false", *WATER[model])
    return Rig("open", *settings, config=config).ready()


def response(model: str, gains: dict[str, object]) -> StepResponse:
    rig = afloat(model, gains, seed=12)
    assert rig.set_mode(Mode.GUIDED) == OK
    assert rig.arm() == OK
    speed_m_s = rig.config.speed.cruise_m_s

    def hold(heading_rad: float, seconds: int) -> list[float]:
        off = []
        for _ in range(seconds):
            rig.boat.vehicle.request(SetPoint(HoldHeading(heading_rad, speed_m_s)))
            rig.boat.guidance.request_update()
            for _ in range(50):
                rig.step()
                off.append(wrap_pi(rig.world.truth.heading_rad - heading_rad) / STEP_RAD)
            rig.peer.listen()
        return off

    hold(0.0, 25)
    off = hold(STEP_RAD, 15)
    rest = sum(off[-250:]) / 250  # what the compass is off by
    off = [one - rest for one in off]
    unsettled = [tick for tick, one in enumerate(off) if abs(one) > 0.1]
    return StepResponse(max(off), sum(abs(one) for one in off) * 0.02, unsettled[-1] * 0.02)


def tuned(rig: Rig, *params: float) -> Rig:
    """After an autotune in LOITER."""
    assert rig.set_mode(Mode.LOITER) == OK
    assert rig.arm() == OK
    rig.run(10.0)
    assert rig.ask(AUTOTUNE, 1.0, *params) == IN_PROGRESS
    rig.until(lambda: not rig.boat.calibration.is_running, 400.0)
    rig.run(0.1)
    return rig


def test_the_autotune_finds_good_gains_from_bad_ones_though_one_side_pulls_less() -> None:
    bad = third("lake")
    rig = afloat("lake", bad, seed=5)
    rig.world._thrusters.right.gain = 0.85
    texts = tuned(rig, 4.0).peer.texts
    assert "Heading autotune done: 5 parameters set" in texts, texts
    before, after = response("lake", bad), response("lake", gains_of(rig.boat.parameters.config))
    assert after.overshoot < min(0.6 * before.overshoot, 0.05)
    assert after.error_s < 0.95 * before.error_s
    assert after.settled_s < before.settled_s
    assert after.settled_s < 3.2


def test_a_small_boat_is_tuned_as_well() -> None:
    rig = tuned(afloat("pool", third("pool"), seed=5), 4.0)
    assert "Heading autotune done: 5 parameters set" in rig.peer.texts
    heading, usual = rig.boat.parameters.config.heading, Rig("open", "boat.model='pool'").config.heading
    assert 0.5 * usual.kp < heading.kp < 2.0 * usual.kp
