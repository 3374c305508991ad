"""Programs for end-to-end tests, ended and looked after when the test is over.

A plugin rather than a conftest.py, which type checking could not tell from the one above it. A test module
asks for it by `pytest_plugins = ("program_fixtures",)`.
"""

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from mavutil_station import MavutilStation, OpenStation
from programs import Program, RunBoat, RunningBoat, RunProgram, start_boat


@pytest.fixture
def rooms(tmp_path: Path) -> Iterator[Path]:
    """Names of rooms that are not taken yet, one after the other."""
    return (tmp_path / f"room-{number}" for number in range(1, 100))


@pytest.fixture
def run_program(rooms: Iterator[Path]) -> Iterator[RunProgram]:
    """Starts any installed program; all of them are ended afterwards."""
    with ExitStack() as ending:

        def run(*arguments: str, environment: dict[str, str] | None = None) -> Program:
            program = Program(next(rooms), arguments, environment)
            ending.callback(program.close)
            return program

        yield run


@pytest.fixture
def running_boat(rooms: Iterator[Path]) -> Iterator[RunBoat]:
    """Starts `boat-sitl serve`. Afterwards each boat that still runs is interrupted and must end with 0."""
    boats: list[RunningBoat] = []

    def run(*arguments: str) -> RunningBoat:
        boats.append(start_boat(next(rooms), *arguments))
        return boats[-1]

    with ExitStack() as ending:
        yield run
        survivors = [boat for boat in boats if boat.program.is_running]
        for boat in boats:
            ending.callback(boat.program.close)
        ending.close()
        ends = [(ended.code, ended.err) for ended in (boat.program.wait(0.0) for boat in survivors)]
        assert ends == [(0, "")] * len(survivors), "a boat ended badly"


@pytest.fixture
def open_station() -> Iterator[OpenStation]:
    """Connects ground stations written on pymavlink; all of them hang up afterwards."""
    with ExitStack() as ending:

        def connect(port: int, system_id: int = 255) -> MavutilStation:
            station = MavutilStation(port, system_id)
            ending.callback(station.close)
            return station

        yield connect
