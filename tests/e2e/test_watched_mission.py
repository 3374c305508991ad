"""`mission-upload --watch`: a raft that no chart has is gone round while the boat sails on."""

import json
import math
from pathlib import Path

import pytest
from patience import JOB_S
from programs import RunBoat, RunProgram

from companion.core.geo import LatLon, LocalFrame

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

RAFT = [(25.0, north) for north in (-1.5, 0.0, 1.5)]  # east, north; each of 1 m in radius
POND = """
[origin]
lat_deg = 50.0
lon_deg = -1.2
[map]
water = [[-20, -40], [70, -40], [70, 40], [-20, 40]]
[route]
start = [0.0, 0.0]
goal = [50.0, 0.0]
clearance_m = 3.0
[boat]
model = "lake"
"""


def test_a_raft_across_the_route_is_gone_round(
    running_boat: RunBoat, run_program: RunProgram, tmp_path: Path
) -> None:
    charted, real = tmp_path / "charted.toml", tmp_path / "real.toml"
    charted.write_text(POND)
    real.write_text(
        POND + "".join(f"[[movers]]\nstart = [{east}, {north}]\nradius_m = 1.0\n" for east, north in RAFT)
    )
    boat = running_boat(str(real), "--speedup", "3")
    program = run_program(
        "mission-upload",
        str(charted),
        *("--connect", boat.url, "--speed", "1.0", "--start", "--watch", "--json"),
    )
    ended = program.wait(JOB_S)
    assert ended.code == 0, ended
    assert "the way ahead is blocked: " in ended.err
    assert "uploaded " in ended.err
    frame = LocalFrame(LatLon(50.0, -1.2))
    track = [frame.to_local(LatLon(lat, lon)) for _, lat, lon, *_ in json.loads(ended.out)["voyage"]["track"]]
    nearest = min(math.hypot(at.east_m - east, at.north_m - north) for at in track for east, north in RAFT)
    assert nearest > 1.2  # a radius of 1 m, and half a hull
    assert track[-1].east_m == pytest.approx(50.0, abs=3.0)
