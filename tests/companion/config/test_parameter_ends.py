"""A boat starts and drives with every parameter at either end of its range: stations may set them there."""

import pytest
from boat_rig import Rig

from companion.config.parameter_table import ROWS
from companion.core.requests import Arm
from companion.core.storage import MemoryStorage

LIVE = [row for row in ROWS if row.path and not row.read_only]
GROUPS = 3  # of parameters that no other of the group is told by


@pytest.mark.parametrize("end", ["low", "high"])
@pytest.mark.parametrize("first", range(GROUPS))
def test_a_boat_starts_with_parameters_at_either_end_of_their_range(first: int, end: str) -> None:
    storage = MemoryStorage()
    lines = [f"{row.name} {getattr(row, end)!r}\n" for row in LIVE[first::GROUPS]]
    storage.content["params.parm"] = "".join(lines).encode()
    rig = Rig(storage=storage)
    assert rig.boat.parameters.loss == ""
    rig.peer.heartbeat()
    rig.run(0.5)
    rig.boat.vehicle.request(Arm(force=True))
    rig.run(0.5)
    assert (rig.boat.net.faults, rig.boat.endpoint.faults) == (0, 0)
