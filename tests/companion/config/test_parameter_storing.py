"""Parameters on a slow medium: what is answered when, and what others have to wait for."""

from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from boat_rig import BOAT, Rig

from companion.boat import TICK_S
from companion.config.parameters import ParameterRow
from companion.core.generations import unseal, write_atomically
from companion.core.storage import FolderStorage
from companion.mavlink.dialect import dialect

FSYNC_S = 0.05
WRITE_S = 2 * FSYNC_S  # the file and its folder
QGC_WAITS_S = 1.0  # for the PARAM_VALUE after its PARAM_SET
VALUE = "PARAM_VALUE"


class SlowWorker(Executor):
    """Carries out one job after the other, each WRITE_S of simulated time after it could begin."""

    def __init__(self) -> None:
        self.jobs: deque[Callable[[], object]] = deque()
        self.done = 0
        self._left_s = WRITE_S

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":  # noqa: ANN401
        """Take a job; its future is not looked at by the storage."""
        self.jobs.append(lambda: fn(*args, **kwargs))
        return Future()

    def tick(self) -> None:
        self._left_s = self._left_s - TICK_S if self.jobs else WRITE_S
        if self._left_s < TICK_S / 2.0:
            self.jobs.popleft()()
            self.done += 1
            self._left_s = WRITE_S


class SlowRig(Rig):
    """A boat on such a medium."""

    def __init__(self, folder: Path, write: Callable[..., None] = write_atomically) -> None:
        self.worker = SlowWorker()
        super().__init__(storage=FolderStorage(folder, write, self.worker))
        self.step()
        self.peer.forget()

    def step(self, ticks: int = 1) -> None:
        for _ in range(ticks):
            super().step()
            self.worker.tick()

    def set(self, name: str, value: float) -> None:
        self.peer.send(
            dialect.MAVLink_param_set_message(*BOAT, name.encode(), value, dialect.MAV_PARAM_TYPE_REAL32)
        )
        self.receive()

    def answers(self) -> list[tuple[str, float]]:
        return [(answer.param_id, answer.param_value) for answer in self.peer.said(VALUE)]


def stored(folder: Path) -> str:
    path = folder / "params.parm"
    return unseal(path.read_bytes()).content.decode() if path.exists() else ""


def free(rig: Rig) -> list[ParameterRow]:
    """Parameters that may be set, and that share their setting with no other."""
    rows = [row for row in rig.boat.parameters.rows if not row.read_only]
    return [row for row in rows if len(rig.boat.parameters.sharing(row.name)) == 1]


def test_a_change_is_answered_once_the_medium_has_it_and_within_the_second_of_a_station(
    tmp_path: Path,
) -> None:
    rig = SlowRig(tmp_path)
    rig.set("WP_RADIUS", 3.25)
    assert rig.boat.parameters.config.guidance.waypoint_radius_m == 3.25  # it is in use at once
    took_s = rig.until(lambda: bool(rig.answers()), QGC_WAITS_S)
    assert WRITE_S - TICK_S <= took_s <= WRITE_S + 2 * TICK_S
    assert rig.answers() == [("WP_RADIUS", 3.25)]
    assert "WP_RADIUS 3.25" in stored(tmp_path)


def test_no_answer_says_a_value_that_a_power_cut_now_would_lose(tmp_path: Path) -> None:
    rig = SlowRig(tmp_path)
    for number in range(60):
        rig.set("WP_RADIUS", 2.0 + number / 16.0)
        rig.step()
        for _, value in rig.answers():
            assert f"WP_RADIUS {value:g}" in stored(tmp_path)
        rig.peer.forget()


def test_two_hundred_changes_are_all_answered_within_the_second(tmp_path: Path) -> None:
    rig = SlowRig(tmp_path)
    rows = free(rig)
    sent = [(row.name, rig.boat.parameters.value(row)) for row in (rows * (200 // len(rows) + 1))[:200]]
    for name, value in sent:
        rig.set(name, value)
    rig.until(lambda: len(rig.answers()) >= 200, QGC_WAITS_S)
    assert sorted(rig.answers()) == sorted(sent)
    assert rig.worker.done <= QGC_WAITS_S / WRITE_S  # a write covers what came during the one before
