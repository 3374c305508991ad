"""The program's log says what the operator is told: what the boat does, and what it refuses."""

import logging
import math

import pytest
from boat_rig import DENIED, FAILED, UNSUPPORTED, Rig

from companion.mavlink.dialect import dialect

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
