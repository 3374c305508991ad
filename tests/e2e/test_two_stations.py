"""Two ground stations on one boat: each gets what it asked for, and both see what either does."""

import pytest
from mavutil_station import MavutilStation, OpenStation
from programs import RunBoat
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

MANUAL = 0


def spacing_ms(station: MavutilStation, kind: str, count: int) -> float:
    """How far apart the next messages of a kind are by the boat's own stamps, on average."""
    first, *_, last = (station.wait_for(kind).time_boot_ms for _ in range(count + 1))
    return float(last - first) / count


def test_each_station_gets_its_own_rates_and_both_see_a_change(
    running_boat: RunBoat, open_station: OpenStation
) -> None:
    boat = running_boat("open")
    fast, slow = open_station(boat.port, 255), open_station(boat.port, 254)
    for station, rate_hz in ((fast, 20), (slow, 2)):
        station.mav.request_data_stream_send(1, 1, dialect.MAV_DATA_STREAM_POSITION, rate_hz, 1)
    set_interval, attitude = dialect.MAV_CMD_SET_MESSAGE_INTERVAL, dialect.MAVLINK_MSG_ID_ATTITUDE
    assert slow.command(set_interval, attitude, 1e6 / 10.0) == dialect.MAV_RESULT_ACCEPTED
    assert fast.command(set_interval, attitude, -1.0) == dialect.MAV_RESULT_ACCEPTED
    for station in (fast, slow):
        station.drain()
    assert spacing_ms(fast, "GLOBAL_POSITION_INT", 20) == pytest.approx(50.0, abs=10.0)
    assert spacing_ms(slow, "GLOBAL_POSITION_INT", 3) == pytest.approx(500.0, abs=50.0)
    assert spacing_ms(slow, "ATTITUDE", 10) == pytest.approx(100.0, abs=20.0)
    heard = {message.get_type() for message in fast.listen(0.5)}
    assert "GLOBAL_POSITION_INT" in heard
    assert "ATTITUDE" not in heard

    assert fast.enter(MANUAL) == dialect.MAV_RESULT_ACCEPTED
    slow.wait_for("HEARTBEAT", lambda heartbeat: heartbeat.custom_mode == MANUAL)
    fast.close()
    slow.drain()
    assert slow.mode() == MANUAL, "it went with the other station"
