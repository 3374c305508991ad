"""Recorded bytes of u-blox receivers, decoded as pyubx2 decodes them."""

import io
from pathlib import Path

import pytest
from pyubx2 import UBXReader
from twins.lines import known

from companion.sensors.ubx.frames import MON_VER, NAV_DOP, NAV_PVT, NAV_RELPOSNED
from companion.sensors.ubx.frames import UbxReader as OwnReader
from companion.sensors.ubx.messages import baseline, horizontal_dop, solution, version

FOLDER = Path(__file__).parents[4] / "shared" / "recordings"
RECORDINGS = sorted(FOLDER.glob("ublox-*.ubx"))
LONGEST = 520  # longer frames are of no use to the boat, and passed over


@pytest.mark.skipif(not RECORDINGS, reason="no recordings of u-blox receivers in ../shared/recordings")
@pytest.mark.parametrize("path", RECORDINGS, ids=lambda path: path.stem)
def test_a_recording_is_read_as_pyubx2_reads_it(path: Path) -> None:
    data, reader = path.read_bytes(), OwnReader()
    frames = [tuple(frame) for at in range(0, len(data), 7) for frame in reader.feed(data[at : at + 7])[0]]
    peer = UBXReader(io.BytesIO(data), protfilter=2, quitonerror=0)
    for raw, message in peer:
        if message is None:
            continue
        kind, payload = int.from_bytes(raw[2:4], "big"), raw[6:-2]
        if len(payload) > LONGEST:
            continue
        assert (kind, payload) in frames
        if kind == NAV_PVT:
            pvt = known(solution(payload))
            assert (pvt.position.lat_deg, pvt.position.lon_deg) == pytest.approx((message.lat, message.lon))
            assert (pvt.north_m_s, pvt.east_m_s) == pytest.approx((message.velN * 1e-3, message.velE * 1e-3))
            assert (pvt.satellites, pvt.position_dop) == pytest.approx((message.numSV, message.pDOP))
            assert pvt.horizontal_accuracy_m == pytest.approx(message.hAcc * 1e-3)
            assert pvt.speed_accuracy_m_s == pytest.approx(message.sAcc * 1e-3)
            assert pvt.unix_time_s is not None
        elif kind == NAV_DOP:
            assert horizontal_dop(payload) == pytest.approx(message.hDOP)
        elif kind == NAV_RELPOSNED:
            found = known(baseline(payload))
            assert (found.heading_rad is not None) == bool(message.relPosHeadingValid)
        elif kind == MON_VER and payload:
            assert version(payload).protocol >= 14.0
