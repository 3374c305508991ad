"""A boat starts and drives with every parameter at either end of its range: stations may set them there."""

import pytest
from boat_rig import Rig, waypoint

from companion.config.parameter_table import ROWS
from companion.config.parameters import ParameterRow
from companion.core.requests import Arm
from companion.core.storage import MemoryStorage

LIVE = [row for row in ROWS if row.path and not row.read_only]


@pytest.mark.parametrize("end", ["low", "high"])
@pytest.mark.parametrize("row", LIVE, ids=lambda row: row.name)
def test_a_boat_starts_with_a_parameter_at_either_end_of_its_range(row: ParameterRow, end: str) -> None:
    storage = MemoryStorage()
    storage.content["params.parm"] = f"{row.name} {getattr(row, end)!r}\n".encode()
    rig = Rig(storage=storage)
    assert rig.boat.parameters.loss == ""
    rig.peer.heartbeat()
    rig.run(1.0)
    rig.boat.vehicle.request(Arm(force=True))
    rig.run(0.5)
    assert (rig.boat.net.faults, rig.boat.endpoint.faults) == (0, 0)


@pytest.mark.parametrize("name", ["CRUISE_THROTTLE", "CRUISE_SPEED", "MOT_SLEWRATE"])
def test_a_boat_sails_with_what_it_drives_by_at_the_low_end(name: str) -> None:
    row = next(row for row in ROWS if row.name == name)
    storage = MemoryStorage()
    storage.content["params.parm"] = f"{name} {row.low!r}\n".encode()
    rig = Rig(storage=storage).sail(waypoint(50.0, 0.0))
    rig.run(20.0)
    assert rig.boat.net.faults == 0


def test_a_setting_beyond_what_a_parameter_carries_is_its_largest_number() -> None:
    rig = Rig(config={"speed.cruise_m_s": 1e38})
    row = next(row for row in ROWS if row.name == "WPNAV_SPEED")
    assert rig.boat.parameters.value(row) == pytest.approx(3.4028235e38)
