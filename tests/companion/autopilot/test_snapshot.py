"""What telemetry, logs and failsafes are told of one tick."""

from types import SimpleNamespace
from typing import cast

import pytest
from msgspec.structs import replace

from companion.autopilot.pipeline import GuidancePipeline
from companion.autopilot.sensor_suite import SensorSuite
from companion.autopilot.snapshot import Snapshot, board_readings
from companion.config.actuators import DriveSetting
from companion.config.boat_config import BoatConfig
from companion.core.readings import DepthReading, EscReading, SonarReading
from companion.core.state import MotorCommand
from companion.failsafe.inputs import HELD_S, BoardReadings
from companion.guidance.stall_detector import StallVerdict
from companion.obstacles.planning.planner import Stage

COMMAND = MotorCommand(0.5, -0.25, rudder=0.1)
AT_START = BoardReadings()
ESCS = EscReading(1.0, 0, 1, 300.0, 12.0, 2.0, 30.0, 0.0), None


def snapshot(layout: str, now_s: float = 1.0, servos: tuple[tuple[int, int], ...] = ()) -> Snapshot:
    payload = SimpleNamespace(units=SimpleNamespace(servo_us=lambda: servos))
    config = replace(BoatConfig(), drive=DriveSetting(layout=layout))  # type: ignore[arg-type]
    rest: dict[str, object] = dict.fromkeys(("vehicle", "estimator", "sensors", "guidance"))
    fields = {"config": config, "command": COMMAND, "payload": payload, "load": 0.0, "rows": (), **rest}
    return Snapshot(now_s=now_s, unix_s=0.0, free_memory_bytes=0, **fields)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("layout", "first_four_us"),
    [
        ("differential", [1750, 0, 1375, 0]),
        ("differential_rudder", [1750, 1550, 1375, 0]),
        ("rudder", [1550, 0, 1750, 0]),
    ],
)
def test_outputs_are_numbered_as_rover_numbers_them(layout: str, first_four_us: list[int]) -> None:
    widths_us = snapshot(layout).output_us
    assert widths_us[:4] == first_four_us
    assert widths_us[4:] == [0] * 12


def test_servos_of_the_payload_follow_the_motors() -> None:
    widths_us = snapshot("differential", servos=((9, 1900), (16, 1100))).output_us
    assert (widths_us[8], widths_us[15]) == (1900, 1100)
    assert widths_us[4:8] + widths_us[9:15] == [0] * 10


def test_the_time_since_boot_wraps_after_49_days_as_mavlink_has_it() -> None:
    late = snapshot("differential", now_s=2.0**32 / 1e3 + 1.5)
    assert late.boot_ms == 1500
    assert late.boot_us == round(2**32 * 1e3) + 1_500_000


class Scene:
    """A boat under way in 3 m of water, with a sonar that pings."""

    def __init__(self) -> None:
        self.stage = Stage.CLEAR
        self.held_s = 0.0
        self.may_touch = self.is_noisy = self.is_calibrating = False
        self.has_sonar, self.sonar = True, SonarReading(1.0, 0.0, None)
        self.has_lidar = False
        self.depth_m: float | None = 3.0

    def board(self, before: BoardReadings = AT_START, *, is_armed: bool = True) -> BoardReadings:
        bottom = None if self.depth_m is None else DepthReading(1.0, self.depth_m)
        sensors = SimpleNamespace(
            bottom=bottom,
            consumed_mah=7.0,
            compass=None,
            hull=None,
            has_sonar=self.has_sonar,
            sonar=self.sonar,
            has_lidar=self.has_lidar,
            lidar=None,
            escs=SimpleNamespace(readings=ESCS),
        )
        guidance = SimpleNamespace(
            avoidance=SimpleNamespace(stage=self.stage),
            headway=SimpleNamespace(held_s=self.held_s, verdict=StallVerdict.MAKING_WAY),
            may_touch=self.may_touch,
            perception=SimpleNamespace(is_noisy=self.is_noisy),
        )
        parts = (cast("SensorSuite", sensors), cast("GuidancePipeline", guidance))
        return board_readings(
            before, *parts, COMMAND, is_calibrating=self.is_calibrating, is_armed=is_armed, min_depth_m=1.0,
            load=0.2, storage_fault="full",
        )  # fmt: skip


def test_motors_are_judged_only_where_the_hull_can_answer_them() -> None:
    assert Scene().board().judges_motors
    for name, value in (
        ("stage", Stage.BACK),
        ("stage", Stage.BLOCKED),
        ("held_s", HELD_S + 0.1),
        ("may_touch", True),
        ("is_calibrating", True),
    ):
        scene = Scene()
        setattr(scene, name, value)
        assert not scene.board().judges_motors, name
    held = Scene()
    held.held_s = HELD_S
    assert held.board().judges_motors


def test_water_was_deep_since_arming_once_it_was() -> None:
    scene = Scene()
    deep = scene.board()
    assert deep.was_deep
    assert not scene.board(is_armed=False).was_deep
    scene.depth_m = 0.9
    assert scene.board(deep).was_deep
    assert not scene.board().was_deep
    assert not scene.board(deep, is_armed=False).was_deep
    scene.depth_m = None
    assert not scene.board().was_deep
    scene.depth_m = 1.0
    assert scene.board().was_deep


def test_a_sonar_is_lost_when_it_falls_silent_or_talks_nonsense_after_it_has_pinged() -> None:
    assert not Scene().board().has_lost_sonar
    silent = Scene()
    silent.sonar = None  # type: ignore[assignment]
    assert silent.board().has_lost_sonar
    silent.has_sonar = False
    assert not silent.board().has_lost_sonar
    noisy = Scene()
    noisy.is_noisy = True
    assert noisy.board().has_lost_sonar


def test_a_lidar_is_lost_when_it_falls_silent_after_it_has_measured() -> None:
    silent = Scene()
    assert not silent.board().has_lost_lidar
    silent.has_lidar = True
    assert silent.board().has_lost_lidar
    assert not silent.board().has_lost_sonar


def test_the_rest_is_passed_on() -> None:
    board = Scene().board()
    assert (board.left, board.right, board.rudder) == (0.5, -0.25, 0.1)
    assert (board.consumed_mah, board.load, board.storage_fault) == (7.0, 0.2, "full")
    assert board.escs is ESCS
