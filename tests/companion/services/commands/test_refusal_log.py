"""The program's log says what the operator is told: what the boat does, and what it refuses."""

import logging
import math
from types import SimpleNamespace
from typing import Any

import pytest
from boat_rig import DENIED, FAILED, UNSUPPORTED, Rig

from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect
from companion.services.commands.command import Result
from companion.services.commands.refusal_log import RefusalLog

CMD = dialect


@pytest.fixture
def journal(caplog: pytest.LogCaptureFixture) -> pytest.LogCaptureFixture:
    caplog.set_level(logging.INFO)
    return caplog


@pytest.fixture
def rig() -> Rig:
    """A boat that could be armed, and logs."""
    rig = Rig().ready()
    rig.boat.endpoint.texts.logs_texts = True
    return rig


def lines(journal: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in journal.records]


@pytest.mark.parametrize(
    ("command", "params", "result", "line"),
    [
        (CMD.MAV_CMD_DO_SET_MODE, (1, 16), FAILED, "DO_SET_MODE by 255/190 refused: FAILED"),
        (CMD.MAV_CMD_DO_SET_MODE, (math.nan, 4), DENIED, "DO_SET_MODE by 255/190 refused: DENIED"),
        (CMD.MAV_CMD_COMPONENT_ARM_DISARM, (2,), DENIED, "COMPONENT_ARM_DISARM by 255/190 refused: DENIED"),
        (CMD.MAV_CMD_NAV_TAKEOFF, (), UNSUPPORTED, "NAV_TAKEOFF by 255/190 refused: UNSUPPORTED"),
        (60000, (), UNSUPPORTED, "MAV_CMD 60000 by 255/190 refused: UNSUPPORTED"),
    ],
)
def test_a_refusal_by_its_number_alone_is_logged(
    rig: Rig,
    journal: pytest.LogCaptureFixture,
    command: int,
    params: tuple[float, ...],
    result: int,
    line: str,
) -> None:
    assert rig.ask(command, *params) == result
    assert line in lines(journal)


def test_repeated_refusals_do_not_fill_the_log(journal: pytest.LogCaptureFixture) -> None:
    """Twenty at once, then one every two seconds."""
    texts: Any = SimpleNamespace(logs_texts=True)
    command: Any = SimpleNamespace(number=22, origin=SimpleNamespace(address=Address(255, 190)))
    log = RefusalLog(texts)
    for result in (Result.ACCEPTED, Result.IN_PROGRESS, Result.CANCELLED):
        log.add(command, result)
    assert (lines(journal), log.dropped) == ([], 0)
    for _ in range(23):
        log.add(command, Result.DENIED)
    assert (len(lines(journal)), log.dropped) == (20, 3)
    log.tick(1.5)
    log.add(command, Result.DENIED)
    assert (len(lines(journal)), log.dropped) == (20, 4)
    log.tick(4.0)
    for now_s in (4.0, 3.0):  # a clock that goes back takes nothing away
        log.tick(now_s)
        log.add(command, Result.DENIED)
    assert (len(lines(journal)), log.dropped) == (22, 4)
    log.tick(1e6)
    texts.logs_texts = False
    log.add(command, Result.DENIED)
    texts.logs_texts = True
    for _ in range(21):
        log.add(command, Result.DENIED)
    assert (len(lines(journal)), log.dropped) == (42, 5)
