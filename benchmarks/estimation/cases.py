"""The recordings that estimators are compared on, and how they are sailed."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sitl.run.mission_run import MissionRun
from sitl.run.sensor_recorder import SensorRecorder, SensorRecording
from sitl.scenarios.layers import Layer
from sitl.scenarios.missions import lay_out, wire_items
from sitl.scenarios.scenario import load_scenario

Settings = dict[str, Any]

_SURVEY: Settings = {"noise_m": 0.01, "wander_m": 0.02, "fix_type": 6}
_SLOW: Settings = {"rate_hz": 1.0}
_POOR: Settings = {"wander_m": 0.4, "velocity_noise_m_s": 0.12, "latency_s": 0.2, "jitter_s": 0.2}
_POOR_COMPASS: Settings = {
    "declination_deg": -6.0, "gyro_scale": 1.04, "hard_iron_deg": 2.0, "soft_iron_deg": 1.0
}  # fmt: skip
# ±30 % of everything that makes the boat slower and lazier, or faster and livelier: other_hulls.toml
_HEAVY: Settings = {
    "hull": {"mass_kg": 10.4, "inertia_kg_m2": 0.975, "skeg_lift_kg_m": 6.3},
    "thrusters": {"propeller": {"thrust_coefficient": 0.217, "torque_coefficient": 0.042}},
}
_LIGHT: Settings = {
    "hull": {"mass_kg": 5.6, "inertia_kg_m2": 0.525, "surge_linear": 0.28, "surge_quadratic": 0.42},
    "thrusters": {
        "propeller": {"thrust_coefficient": 0.403, "torque_coefficient": 0.078},
        "motor": {"no_load_a": 0.39},
    },
}
HULLS: dict[str, Settings] = {"known": {}, "heavy": _HEAVY, "light": _LIGHT}


@dataclass(frozen=True)
class Case:
    """A run to record. settings as in a campaign; timeout_s of a station run."""

    name: str
    course: str
    seed: int
    settings: Settings = field(default_factory=dict)
    timeout_s: float | None = None
    linger_s: float = 0.0


def environment(current_m_s: float, to_deg: float = 90.0) -> Settings:
    """A current, with gusts where it is not 0."""
    if not current_m_s:
        return {}
    return {
        "current_m_s": current_m_s, "current_to_deg": to_deg,
        "wind_m_s": 5.0, "gust_m_s": 8.0, "wind_from_deg": 90.0,
    }  # fmt: skip


def courses(seeds: range) -> Iterator[Case]:
    """Straight and zigzag: calm, 0.5 and 1 m/s, receivers, rates, hulls, no gyro, poor sensors, ghosts."""
    for seed in seeds:
        for current_m_s in (0.0, 0.5, 1.0):
            water = {"environment": environment(current_m_s, (90.0, 180.0, 0.0, 270.0)[seed % 4])}
            for name, gnss in (
                ("standard", {}), ("survey", _SURVEY), ("1hz", _SLOW), ("survey_1hz", {**_SURVEY, **_SLOW})
            ):  # fmt: skip
                yield Case(
                    f"zigzag_{current_m_s:g}_{name}_{seed}",
                    "zigzag",
                    seed,
                    {**water, "sensors": {"gnss": gnss}},
                )
            yield Case(f"straight_{current_m_s:g}_standard_{seed}", "straight", seed, water)
        water = {"environment": environment(0.5, (90.0, 180.0, 0.0, 270.0)[seed % 4])}
        for hull in ("heavy", "light"):
            for name, gnss in (("standard", {}), ("1hz", _SLOW)):
                yield Case(
                    f"zigzag_0.5_{name}_{hull}_{seed}", "zigzag", seed,
                    {**water, **HULLS[hull], "sensors": {"gnss": gnss}},
                )  # fmt: skip
        poor = {**water, "sensors": {"gnss": _POOR, "compass": _POOR_COMPASS}}
        yield Case(f"zigzag_0.5_poor_sensors_{seed}", "zigzag", seed, poor)
        no_gyro = [{"what": "gyro", "kind": "off", "at_s": 0.0}]
        yield Case(f"zigzag_0.5_no_gyro_{seed}", "zigzag", seed, {**water, "faults": no_gyro})
        ghosts = {**water, "sensors": {"sonar": {"ghost_share": 0.02}}}
        yield Case(f"zigzag_0.5_ghosts_{seed}", "zigzag", seed, ghosts)
        yield Case(
            f"station_1_standard_{seed}", "station", seed,
            {"environment": environment(1.0, 180.0)}, timeout_s=300.0,
        )  # fmt: skip


FAULTS: dict[str, Settings] = {
    "gnss_off": {"what": "gnss", "kind": "off"},
    "gnss_no_fix": {"what": "gnss", "kind": "no_fix"},
    "gnss_stuck": {"what": "gnss", "kind": "stuck", "for_s": 30.0},
    "gnss_wrong": {"what": "gnss", "kind": "wrong", "size": 10.0, "for_s": 30.0},
    "gnss_garbage": {"what": "gnss", "kind": "garbage", "size": 50.0, "for_s": 30.0},
    "gnss_drift": {"what": "gnss", "kind": "drift", "size": 0.3, "for_s": 60.0},
    "gnss_delayed": {"what": "gnss", "kind": "delayed", "size": 1.0, "for_s": 60.0},
    "compass_off": {"what": "compass", "kind": "off", "for_s": 30.0},
    "compass_stuck": {"what": "compass", "kind": "stuck", "for_s": 30.0},
    "compass_wrong": {"what": "compass", "kind": "wrong", "size": 45.0, "for_s": 30.0},
    "compass_drift": {"what": "compass", "kind": "drift", "size": 1.0, "for_s": 60.0},
    "compass_garbage": {"what": "compass", "kind": "garbage", "for_s": 30.0},
    "compass_delayed": {"what": "compass", "kind": "delayed", "size": 0.5, "for_s": 60.0},
    "gyro_off": {"what": "gyro", "kind": "off", "for_s": 30.0},
    "gyro_stuck": {"what": "gyro", "kind": "stuck", "for_s": 30.0},
    "gyro_wrong": {"what": "gyro", "kind": "wrong", "size": 5.0, "for_s": 60.0},
    "gyro_garbage": {"what": "gyro", "kind": "garbage", "size": 60.0, "for_s": 30.0},
}


def faults(seeds: range) -> Iterator[Case]:
    """Each sensor fault on a straight in a side current, as examples/campaigns/sensor_faults.toml."""
    for seed in seeds:
        for name, fault in FAULTS.items():
            yield Case(
                f"fault_{name}_{seed}", "straight", seed,
                {
                    "environment": {"current_m_s": 0.5, "current_to_deg": 90.0},
                    "faults": [{"at_s": 30.0, **fault}],
                },
                linger_s=10.0,
            )  # fmt: skip


def record(case: Case) -> tuple[SensorRecording, bool]:
    """Sail a case; its recording, and whether it was completed."""
    scenario = load_scenario("open", over=(Layer("estimation", {**case.settings, "seed": case.seed}),))
    recorder = SensorRecorder()
    mission_run = MissionRun(scenario, wire_items(lay_out(case.course, scenario)), sensors=recorder)
    result = mission_run.run(case.timeout_s, linger_s=case.linger_s)
    return recorder.recording(scenario, case.name), result.completed


def record_all(cases: Iterable[Case], folder: Path) -> None:
    """Record what the folder does not have yet."""
    folder.mkdir(parents=True, exist_ok=True)
    for case in cases:
        path = folder / f"{case.name}.npz"
        if not path.exists():
            recording, is_completed = record(case)
            recording.save(path)
            print(case.name, "completed" if is_completed else "NOT completed", flush=True)  # noqa: T201
