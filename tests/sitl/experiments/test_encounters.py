"""The avoidance experiment: obstacles drawn from a seed, movers on a collision course, and the table."""

import math

import pytest

from companion.core.geo import Point
from sitl.experiments.encounters.avoiding import side_changes
from sitl.experiments.encounters.encounter import Encounter, encounter_trials, run_encounter
from sitl.experiments.encounters.obstacles import LEG_M, Kind, Meeting, mover, still_obstacles
from sitl.experiments.encounters.table import markdown, run_rows, summary
from sitl.experiments.trial import TrialResult
from sitl.world.movers import Mover, MoverSettings

pytestmark = pytest.mark.slow

MOVING: tuple[Kind, ...] = ("head_on", "crossing")


@pytest.mark.parametrize("kind", MOVING)
@pytest.mark.parametrize("seed", range(1, 3))
def test_what_moves_is_aimed_at_where_the_boat_would_be(kind: Kind, seed: int) -> None:
    meeting = Meeting(40.0, Point(30.0, 0.2), 0.05)
    tree = mover(kind, seed, 0.5, meeting)
    east_m, north_m = Mover(MoverSettings(**tree)).position_m(meeting.time_s)
    assert math.hypot(north_m - meeting.at.north_m, east_m - meeting.at.east_m) <= 0.5
    assert math.hypot(*tree["velocity_m_s"]) == pytest.approx(0.5)


def test_rocks_leave_the_ends_of_the_leg_free() -> None:
    for seed in range(1, 20):
        for rock in still_obstacles("dense", seed)["map"]["obstacles"]:
            east_m, north_m = rock["circle"]["centre"]
            to_ends_m = min(math.hypot(north_m, east_m), math.hypot(north_m - LEG_M, east_m))
            assert to_ends_m > rock["circle"]["radius_m"] + 4.0


@pytest.mark.parametrize(
    ("sonar", "is_unheard"), [({"ranger": "ideal"}, False), ({"fitted": False}, True)], ids=["heard", "deaf"]
)
def test_without_avoidance_what_moves_is_touched_though_it_could_be_helped(
    sonar: dict[str, object], is_unheard: bool
) -> None:
    settings = {"vehicle": {"avoidance": {"enable": 1}}, "sensors": {"sonar": sonar}}
    (trial,) = encounter_trials([Encounter("crossing", 0.2)], [1], settings)
    figures = run_encounter(trial).figures
    assert figures["touches"]
    assert not figures["inevitable"]
    assert figures["unheard"] is is_unheard


def test_the_side_changes_where_another_one_is_reported() -> None:
    port, starboard = "Obstacle: passing to port", "Obstacle: passing to starboard"
    texts = [port, "Armed", port, starboard, "Obstacle: trying again", port]
    assert side_changes(texts) == 2
    assert side_changes([]) == 0


@pytest.mark.parametrize("avoids", [True, False])
def test_travel_counts_while_the_boat_avoids_something(avoids: bool) -> None:
    avoidance = {} if avoids else {"enable": 1}
    settings = {"sensors": {"sonar": {"ranger": "ideal"}}, "vehicle": {"avoidance": avoidance}}
    (trial,) = encounter_trials([Encounter("lone")], [1], settings)
    result = run_encounter(trial)
    avoiding_s, travel = result.value("avoiding_s"), result.value("avoiding_travel")
    if not avoids:
        assert (avoiding_s, travel) == (0.0, 0.0)
        return
    assert 3.0 < avoiding_s < 60.0
    assert 1.0 < travel < 4.0 * avoiding_s, "at most the slew rate"


def test_the_summary_counts_touched_runs_by_kind_and_the_time_lost() -> None:
    encounters = [Encounter("lone"), Encounter("head_on", 0.5)]
    trials = encounter_trials(encounters, [1, 2], {})
    figures = {"time_s": 33.0, "alone_s": 30.0, "moves_told": 0, "no_way_told": 0, "side_changes": 1}
    figures |= {"avoiding_s": 15.0, "avoiding_travel": 10.0}
    results = [
        TrialResult(
            number=number,
            ended=ended,
            figures={**figures, "touches": touches, "inevitable": is_inevitable, "unheard": is_unheard},
        )
        for number, (ended, touches, is_inevitable, is_unheard) in enumerate(
            [
                ("completed", 3, False, False),
                ("not completed", 0, False, False),
                ("completed", 1, True, True),
                ("completed", 1, False, True),
            ],
            1,
        )
    ]
    assert summary(trials, results) == (
        "still: 1 touches of 2; movers: 2 of 2, 1 inevitable, 2 unheard; shore: 0 of 0; "
        "time lost: still 10 %, movers 10 %, shore unknown; "
        "beside still: motor travel 40 a minute, side changes 2"
    )
    assert markdown(trials, results).splitlines()[2] == ("| lone | 2 | 1 |  |  | 1 | 1.10 | 0 | 0 | 40 | 2 |")
    assert [(row["encounter"], row["seed"]) for row in run_rows(trials, results)] == [
        ("lone", 1), ("lone", 2), ("head on 0.5 m/s", 1), ("head on 0.5 m/s", 2),
    ]  # fmt: skip
