"""What a boat draws, learned from logs: written by hand record by record, and by an emulated boat."""

import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from companion.core.geo import Point
from companion.log.logbook import Logbook
from companion.log.sink import SingleFile
from mission_tools.cli.plan_command import run_program
from mission_tools.contract.budget import budget_of
from mission_tools.costs.boat import load_boat
from mission_tools.costs.current import UniformCurrent
from mission_tools.costs.learned_draw import learn_draw
from mission_tools.errors import MapError
from mission_tools.mission.route import mission_along
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import load_scenario
from sitl.world.truth import Truth

Record = tuple[str, float, float, float]
KINDS = {"BAT": (24, "QBf", "TimeUS,Inst,Curr"), "EST": (11, "Qff", "TimeUS,CurN,CurE")}
KINDS["XKF1"] = (3, "QBff", "TimeUS,C,VN,VE")


def written(path: Path, records: Sequence[Record]) -> Path:
    """A log of (kind, seconds, first, second value), in DataFlash's own bytes."""
    data = b""
    for name, (kind, letters, labels) in KINDS.items():
        length = 3 + struct.calcsize("<" + letters)
        data += b"\xa3\x95\x80" + struct.pack(
            "<BB4s16s64s", kind, length, name.encode(), letters.encode(), labels.encode()
        )
    for name, at_s, one, other in records:
        kind, letters, _ = KINDS[name]
        values = {"BAT": (0, one), "EST": (one, other), "XKF1": (0, one, other)}[name]
        data += b"\xa3\x95" + bytes([kind]) + struct.pack("<" + letters, round(1e6 * at_s), *values)
    path.write_bytes(data)
    return path


def sailed(
    speeds: Sequence[tuple[float, float]], flow: tuple[float, float] = (0.0, 0.0), stretch_s: int = 45
) -> list[Record]:
    """Northwards at these speeds through the water and currents drawn, one after the other, read at 1 Hz."""
    found: list[Record] = []
    for speed_m_s, drawn_a in speeds:
        for _ in range(stretch_s):
            at_s = len(found) / 3.0 + 1.0
            found += [
                ("EST", at_s, *flow),
                ("XKF1", at_s, speed_m_s + flow[0], flow[1]),
                ("BAT", at_s, drawn_a, 0.0),
            ]
    return found


def test_steady_speeds_become_pairs_slowest_first_and_the_current_of_the_water_is_taken_off(
    tmp_path: Path,
) -> None:
    log = written(tmp_path / "1.bin", sailed([(2.0, 2.7), (1.0, 1.1), (1.5, 1.7)], (-0.4, 0.3)))
    found = learn_draw([log])
    assert [speed for speed, _ in found] == pytest.approx([1.0, 1.5, 2.0], rel=1e-3)
    assert [drawn for _, drawn in found] == pytest.approx([1.1, 1.7, 2.7], rel=1e-3)


def test_several_logs_count_together(tmp_path: Path) -> None:
    logs = [written(tmp_path / f"{n}.bin", sailed([(1.0 + n, 1.0 + n)], stretch_s=30)) for n in range(3)]
    assert [round(speed, 3) for speed, _ in learn_draw(logs)] == [1.0, 2.0, 3.0]


def test_a_faster_band_that_draws_less_is_left_out(tmp_path: Path) -> None:
    log = written(tmp_path / "1.bin", sailed([(1.0, 1.2), (1.5, 1.1), (2.0, 3.0)], stretch_s=50))
    assert [round(speed, 3) for speed, _ in learn_draw([log])] == [1.0, 2.0]


def test_changing_speeds_drifting_and_what_is_below_idle_teach_nothing(tmp_path: Path) -> None:
    def later(by_s: float, records: list[Record]) -> list[Record]:
        return [(name, at_s + by_s, one, other) for name, at_s, one, other in records]

    speeding_up = sailed([(0.2 + 0.1 * n, 2.0) for n in range(30)], stretch_s=1)
    records = sailed([(2.0, 2.7)]) + later(100.0, speeding_up)
    records += later(200.0, sailed([(0.05, 0.6)])) + later(300.0, sailed([(1.0, 0.55)]))
    log = written(tmp_path / "1.bin", records)
    assert [round(speed, 2) for speed, _ in learn_draw([log], idle_a=0.58)] == [2.0]


@pytest.mark.parametrize("content", [b"", b"no log at all", b"\xa3\x95\x80" * 40])
def test_a_log_that_teaches_nothing_says_what_to_sail(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "1.bin").write_bytes(content)
    with pytest.raises(MapError, match=r"1\.bin: no speed that was steady for 20 s.*sail straight legs"):
        learn_draw([tmp_path / "1.bin"])


def test_a_log_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(MapError, match=r"none\.bin: cannot be read: No such file"):
        learn_draw([tmp_path / "none.bin"])


def test_the_command_prints_the_table_for_the_boats_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = written(tmp_path / "1.bin", sailed([(0.6, 0.93), (1.0, 1.16)]))
    assert run_program(["--learn", str(log), "--boat", "kit"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "[battery]"
    assert lines[1] == "draw = [[0.6, 0.93], [1, 1.16]]  # m/s through still water, A"
    assert run_program(["--learn", str(tmp_path / "none.bin")]) == 2
    assert run_program(["--json"]) == 2
    assert "SOURCE is missing" in capsys.readouterr().err


@pytest.mark.slow
def test_a_curve_that_an_emulated_boat_logged_plans_its_charge_within_ten_percent(tmp_path: Path) -> None:
    known = load_boat("catamaran")
    logs = []
    for number, speed_m_s in enumerate((0.7, 1.2, 1.7, 2.6)):
        log = tmp_path / f"{number}.bin"
        _sail([Point(0.0, 0.0), Point(60.0 * speed_m_s, 0.0)], speed_m_s, [], log)
        logs.append(log)
    learned = replace(known, draw=learn_draw(logs, known.idle_a))
    assert len(learned.draw) >= 4
    way = [Point(0.0, 0.0), Point(120.0, 0.0)]
    current = ["environment.current_m_s=0.4", "environment.current_to_deg=180"]
    found = budget_of(way, [0.0], [0.0, 120.0], learned, None, UniformCurrent(-0.4, 0.0))
    assert found.charge_mah == pytest.approx(_sail(way, None, current), rel=0.1)


def _sail(way: list[Point], speed_m_s: float | None, settings: list[str], log: Path | None = None) -> float:
    """What is drawn, in mAh."""
    scenario = load_scenario("open", ["boat.model=catamaran", "seed=1001", *settings])
    mission = mission_along([scenario.frame.to_global(point) for point in way], speed_m_s)
    logbook = None if log is None else Logbook(SingleFile(log))
    run = MissionRun(scenario, wire_items(mission), logbook)
    assert run.run().completed
    return float(run.sailed_rows[:, Truth._fields.index("current_a")].sum()) * 0.02 / 3.6
