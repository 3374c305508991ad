"""The log says what the payload was given, and where."""

from pathlib import Path

import pytest
from boat_rig import waypoint
from log_rig import LogRig, of_kind, read_log
from payload_rig import CAMERA, PAYLOAD

from companion.core.geo import LatLon
from companion.mavlink.items import MissionItem


def test_payload_actions_and_images_are_logged_with_their_place(tmp_path: Path) -> None:
    rig = LogRig(tmp_path, PAYLOAD, CAMERA)
    servo = MissionItem(2, 183, param1=9.0, param2=1250.0)
    image = MissionItem(2, 2000, param3=1.0)
    rig.sail(waypoint(12, 0), servo, image, waypoint(24, 0))
    rig.until(lambda: rig.mode != "AUTO", 60.0)
    rig.disarm()
    rig.boat.close()
    records = read_log(tmp_path / "00001.bin")
    (written,) = [one for one in of_kind(records, "PAYL") if one.Val == 1250.0]
    (taken,) = of_kind(records, "CAM")
    assert written.Name.startswith("servo 9 (bait)")
    frame = rig.scenario.frame
    for one in (written, taken):
        point = frame.to_local(LatLon(one.Lat, one.Lng))
        assert abs(point.north_m - 12.0) < 3.0
        assert abs(point.east_m) < 3.0
    assert taken.TimeUS == pytest.approx(written.TimeUS, abs=40_000)  # at the shutter
    assert taken.Img == 0
    assert min(taken.Y, 360.0 - taken.Y) < 20.0
    assert [one.C9 for one in of_kind(records, "RCOU")][-1] == 1250
