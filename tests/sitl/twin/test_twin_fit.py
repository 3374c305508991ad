import math
import tomllib
from dataclasses import replace
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace as with_fields
from numpy.typing import NDArray
from twin_rig import PACK_OHM, measured_voyage

from sitl.__main__ import run_program
from sitl.scenarios.scenario import BOATS, load_scenario
from sitl.twin.boat_file import boat_text, fitted_entries, own_settings, scaled_base
from sitl.twin.fit import Fit, factors_of, fit_boat
from sitl.twin.response import FIGURES, response

STEP_S = 0.1
OTHER = (
    "hull.surge_quadratic=0.8", "hull.inertia_kg_m2=1.0", "hull.yaw_linear=0.26", "hull.skeg_lift_kg_m=11",
    "thrusters.propeller.thrust_coefficient=0.25", "thrusters.propeller.astern_share=0.7",
    "thrusters.motor.inertia_kg_m2=1.6e-5", "thrusters.left_gain=0.97", "thrusters.right_gain=1.03",
)  # fmt: skip


def held(*commands: tuple[float, float, float]) -> NDArray[np.float64]:
    """Commands of left and right, each for some seconds."""
    return np.concatenate([np.tile([left, right], (round(s / STEP_S), 1)) for s, left, right in commands])


ZIGZAG = held(
    *[(7.0, 0.5, 0.5), (9.0, 1.0, 1.0), (6.0, 0.0, 0.0), (4.0, -0.6, -0.6)],
    *[(2.5, 0.9, 0.2), (2.5, 0.2, 0.9), (3.0, 0.6, -0.5), (3.0, -0.5, 0.6)] * 5,
    *[(5.0, 0.2, 0.25), (8.0, 0.7, 0.5), (12.0, 0.3, 0.3)],
)


@pytest.fixture(scope="module")
def fitted() -> Fit:
    """The boat of OTHER from a voyage of it, beginning with the lake boat."""
    return fit_boat(
        load_scenario("open"), [measured_voyage(load_scenario("open", OTHER), ZIGZAG, STEP_S, seed=3)]
    )


def test_a_boat_is_recovered_from_its_voyage_within_what_the_fit_states(fitted: Fit) -> None:
    truth = load_scenario("open", (*OTHER, f"thrusters.left_gain={math.sqrt(0.97 / 1.03)}"))
    wanted = [math.log(attrgetter(key)(truth) / attrgetter(key)(fitted.base)) for key in fitted.keys]
    off = (fitted.logs - wanted) / np.sqrt(np.diag(fitted.covariance))
    assert np.mean(np.abs(off[fitted.told]) < 1.96) >= 0.9
    changed = [n for n, key in enumerate(fitted.keys) if any(one.startswith(f"{key}=") for one in OTHER)]
    assert fitted.told[changed].all()
    figures = response(truth, {}, PACK_OHM)[:, 0]
    found = response(fitted.base, factors_of(fitted.keys, fitted.logs[None]), PACK_OHM)[:, 0]
    assert dict(zip(FIGURES, found / figures, strict=True)) == pytest.approx(
        dict.fromkeys(FIGURES, 1.0), abs=0.03
    )


def test_without_wind_it_says_that_windage_cannot_be_told_and_keeps_the_base_boats(fitted: Fit) -> None:
    told = dict(zip(fitted.keys, fitted.told.tolist(), strict=True))
    for key in ("hull.windage.frontal_drag", "hull.windage.lateral_drag"):
        assert not told[key]
        value, comment = fitted_entries(fitted)[key]
        assert value == attrgetter(key)(fitted.base)
        assert "cannot be told from this voyage; tell it by" in comment


def test_the_torque_is_raised_until_the_propeller_gives_no_more_power_than_it_takes(fitted: Fit) -> None:
    more = replace(
        fitted, logs=fitted.logs + [0.8 * key.endswith("thrust_coefficient") for key in fitted.keys]
    )
    base, found, key = fitted.base.thrusters.propeller, fitted_entries(more), "thrusters.propeller."
    names = ("thrust_coefficient", "torque_coefficient", "zero_thrust_advance", "zero_torque_advance")
    values = {name: float(str(found[key + name][0])) for name in names}
    with_fields(base, **values)
    values["torque_coefficient"] *= 0.99
    with pytest.raises(ValueError, match="more power than it takes"):
        with_fields(base, **values)
    assert "raised by" in found["thrusters.motor.resistance_ohm"][1]


def test_the_hulls_deep_part_is_no_longer_than_the_hull(fitted: Fit) -> None:
    more = replace(fitted, logs=fitted.logs + [0.8 * ("crossflow" in key) for key in fitted.keys])
    assert fitted_entries(more)["hull.crossflow_length_m"][0] == fitted.base.hull.length_m


def test_the_boats_file_is_toml_that_the_emulator_loads(fitted: Fit, tmp_path: Path) -> None:
    base = load_scenario("open")
    entries = {**fitted_entries(fitted), **own_settings(base, {"HDG_KP": 5.5, "SYSID_THISMAV": 7.0})}
    path = tmp_path / "mine.toml"
    path.write_text(boat_text((BOATS / "lake.toml").read_text(encoding="utf-8"), "# mine", entries))
    tree = tomllib.loads(path.read_text(encoding="utf-8"))
    assert tree["vehicle"]["heading"] == {"kp": 5.5}
    loaded = load_scenario("open", [f"boat.model={path}"])
    for n, key in enumerate(fitted.keys):
        wanted = attrgetter(key)(base) * math.exp(fitted.logs[n])
        assert attrgetter(key)(loaded) == pytest.approx(wanted, rel=1e-4), key
    assert loaded.thrusters.right_gain == pytest.approx(1.0 / loaded.thrusters.left_gain, rel=1e-4)
    assert loaded.sensors == base.sensors
    assert "identity" not in tree["vehicle"]


def test_a_mass_changes_all_forces_and_no_motion() -> None:
    base = load_scenario("open")
    heavy = scaled_base(base, 12.0, 0.4)
    assert (heavy.hull.mass_kg, heavy.thrusters.apart_m) == (12.0, 0.4)
    moved = response(scaled_base(base, 12.0, None), {}, 0.0)[[0, 2]]
    # Windage alone does not grow with the mass.
    assert moved == pytest.approx(response(base, {}, 0.0)[[0, 2]], rel=0.03)


def test_a_log_or_a_voyage_to_sail_is_expected(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_program(["fit"]) == 2
    assert "LOG is missing" in capsys.readouterr().err
    assert run_program(["fit", "x.bin", "--base", "rudder"]) == 2
    assert "steers by two motors" in capsys.readouterr().err
    plan = tmp_path / "evening.waypoints"
    assert run_program(["fit", "--voyage", str(plan), "--start", "50.0,-1.2"]) == 0
    assert len(plan.read_text(encoding="utf-8").splitlines()) > 30
