"""Motor travel and commands astern at speed, from made-up truths in real worlds."""

from typing import cast

import pytest
from boat_rig import scenario

from companion.core.geo import Point
from sitl.experiments.campaign.calm_figures import calm_figures
from sitl.run.mission_run import MissionRun
from sitl.run.recording.recorder import Recorder
from sitl.world.truth import Truth
from sitl.world.world import World

TICK_S = 0.02
STILL = Truth(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False)


class StubBoat:
    """Without a fence."""

    class estimator:  # noqa: N801
        frame = None


class StubLockstep:
    def __init__(self, world: World) -> None:
        self.world, self.boat = world, StubBoat


class StubRun:
    """What the figures read of a run."""

    def __init__(self, planned: list[Point], *settings: str) -> None:
        self.scenario = scenario("open", *settings)
        self.lockstep = StubLockstep(World(self.scenario))
        self.planned, self.recorder = planned, Recorder()

    def add(self, seconds: float, **truth: float) -> None:
        for _ in range(round(seconds / TICK_S)):
            self.recorder.record(Truth(**{**STILL._asdict(), **truth, "time_s": len(self.recorder) * TICK_S}))

    @property
    def sailed_rows(self) -> object:
        return self.recorder.rows

    @property
    def figures(self) -> dict[str, float | None]:
        return calm_figures(cast("MissionRun", self))


FAR = [Point(0.0, 0.0), Point(1000.0, 0.0)]
FAST = {"surge_m_s": 2.0, "north_m_s": 2.0}


def test_travel_counts_full_scales_a_minute_of_the_busier_motor() -> None:
    run = StubRun(FAR)
    for _ in range(30):
        run.add(1.0, left_command=0.5, right_command=0.25)
        run.add(1.0, left_command=0.0, right_command=0.0)
    # 59 changes in 59.9 s between the first and the last sample
    assert run.figures["motor_travel_per_min"] == pytest.approx(59 * 0.5 * 60.0 / 59.9)


def test_astern_at_speed_in_open_water_has_no_cause() -> None:
    run = StubRun(FAR)
    run.add(10.0, **FAST, left_command=0.6, right_command=0.6)
    run.add(1.0, **FAST, left_command=-0.5, right_command=0.1)
    run.add(1.0, **FAST, left_command=0.1, right_command=-0.5)
    run.add(1.0, surge_m_s=0.69, left_command=-0.5, right_command=-0.5)
    figures = run.figures
    assert figures["astern_false_s"] == pytest.approx(2.0)
    assert figures["astern_caused_s"] == 0.0


@pytest.mark.parametrize(
    ("planned", "settings"),
    [
        (FAR, "movers=[{start=[0.0, 4.4]}]"),  # its edge 3.9 m ahead
        ([Point(0.0, 0.0), Point(8.9, 0.0)], "seed=1"),  # 2 m/s · 1 s + (2 m/s)² / 0.8 m/s² + 2 m = 9 m
    ],
    ids=["mover", "end"],
)
def test_astern_at_speed_before_something_real_has_a_cause(planned: list[Point], settings: str) -> None:
    run = StubRun(planned, settings)
    run.add(2.0, **FAST, left_command=-0.5, right_command=-0.5)
    figures = run.figures
    assert figures["astern_caused_s"] == pytest.approx(2.0)
    assert figures["astern_false_s"] == 0.0


@pytest.mark.parametrize(
    ("planned", "settings"),
    [
        (FAR, "movers=[{start=[0.0, 4.6]}]"),  # out of the ranger's reach
        (FAR, "movers=[{start=[0.0, -2.0]}]"),  # astern
        ([Point(0.0, 0.0), Point(9.1, 0.0)], "seed=1"),
    ],
    ids=["far", "behind", "end"],
)
def test_what_is_out_of_sight_is_no_cause(planned: list[Point], settings: str) -> None:
    run = StubRun(planned, settings)
    run.add(2.0, **FAST, left_command=-0.5, right_command=-0.5)
    assert run.figures["astern_false_s"] == pytest.approx(2.0)


def test_a_cause_counts_for_a_second() -> None:
    run = StubRun(FAR, "movers=[{start=[0.0, 4.0]}]")
    run.add(0.1, **FAST, left_command=0.5, right_command=0.5)
    run.add(3.0, **FAST, north_m=100.0, left_command=-0.5, right_command=-0.5)
    figures = run.figures
    assert figures["astern_caused_s"] == pytest.approx(1.0)
    assert figures["astern_false_s"] == pytest.approx(2.0)
