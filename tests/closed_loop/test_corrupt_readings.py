"""One reading in a hundred is corrupt: the boat sails as if none were, and nothing alarms its operator."""

from functools import cache

import pytest
from boat_rig import HOME_ITEM, scenario, waypoint

from sitl.run.mission_run import MissionRun, Result

ZIGZAG = [HOME_ITEM, *(waypoint(20.0 * leg, 15.0 * (leg % 2)) for leg in range(1, 4))]
FITTED = (
    "sensors.depth.fitted=true",
    "vehicle.failsafe.min_depth_m=0.8",
    "sensors.rc.fitted=true",
    "vehicle.failsafe.battery_low_v=10.5",
)


def corrupt(part: str) -> str:
    return f"{{what='{part}', kind='corrupt'}}"


@cache
def sail(seed: int, faults: str) -> tuple[Result, list[str]]:
    mission_run = MissionRun(scenario("open", *FITTED, f"seed={seed}", f"faults=[{faults}]"), ZIGZAG)
    result = mission_run.run()
    return result, [event.text for event in mission_run.timeline.events if event.kind == "text"]


@pytest.mark.parametrize("part", ["gyro", "compass", "gnss", "battery", "sonar", "depth", "rc"])
@pytest.mark.parametrize("seed", [9501, 9502])
def test_single_corrupt_readings_of_a_part_change_nothing(part: str, seed: int) -> None:
    healthy, _ = sail(seed, "")
    result, texts = sail(seed, corrupt(part))
    assert result.completed, texts
    assert result.cross_track_rms_m is not None
    assert healthy.cross_track_rms_m is not None
    assert result.cross_track_rms_m < 1.2 * healthy.cross_track_rms_m
    assert not [text for text in texts if "Failsafe" in text or "motors" in text]


def test_single_corrupt_readings_of_all_parts_at_once_end_no_mission() -> None:
    healthy, _ = sail(9501, "")
    result, texts = sail(9501, ", ".join(map(corrupt, ("gyro", "compass", "gnss", "battery", "sonar"))))
    assert result.completed, texts
    assert result.cross_track_rms_m is not None
    assert healthy.cross_track_rms_m is not None
    assert result.cross_track_rms_m < 1.3 * healthy.cross_track_rms_m
