"""AIS_VESSEL on a whole boat: as pymavlink decodes it, by the rules of ArduPilot's AP_AIS (flags, and values
of fields that are not known) and of MAVProxy's module ais (sizes), and when it is sent.
"""

import math
from typing import Any

import pytest
from boat_rig import BOAT, Rig
from msgspec.structs import replace
from twins.lines import known

from companion.core.geo import LatLon
from companion.core.readings import AisReading, AisVessel
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect
from companion.services.telemetry.ais_messages import VesselSchedule, ais_vessel

FERRY = AisVessel(
    235_001_234, 100.0, LatLon(50.76, -1.3), 10.0, math.radians(123.4), math.radians(120.0),
    math.radians(-0.5), status=0, kind=60, is_accurate=True, name="RED FALCON", callsign="GBAB",
    bow_m=60, stern_m=33, port_m=8, starboard_m=9,
)  # fmt: skip
UNKNOWN = AisVessel(1, 100.0, LatLon(50.76, -1.3))
KNOWN = 1 | 2 | 4 | 16 | 64 | 2048 | 4096


def decoded(vessel: AisVessel, now_s: float = 103.4) -> Message:
    """Through the bytes of a frame."""
    (heard,) = dialect.MAVLink(None).parse_buffer(Encoder(BOAT).encode(ais_vessel(vessel, now_s)))
    return heard  # type: ignore[no-any-return]


def test_a_known_vessel_has_its_values_in_mavlinks_units() -> None:
    one = decoded(FERRY)
    assert (one.MMSI, one.lat, one.lon, one.flags) == (235_001_234, 507_600_000, -13_000_000, KNOWN)
    assert (one.COG, one.heading, one.velocity, one.turn_rate) == (12_340, 12_000, 1000, -50)
    assert (one.dimension_bow, one.dimension_stern) == (60, 33)
    assert (one.dimension_port, one.dimension_starboard) == (8, 9)
    assert (one.navigational_status, one.type, one.tslc) == (0, 60, 3)
    assert (one.callsign, one.name) == ("GBAB", "RED FALCON")


def test_what_is_not_known_has_no_flag_and_ardupilots_values() -> None:
    one = decoded(UNKNOWN)
    assert one.flags == 0
    assert (one.COG, one.heading, one.velocity, one.turn_rate) == (65535, 65535, 65535, 127)
    sides_m = one.dimension_bow, one.dimension_stern, one.dimension_port, one.dimension_starboard
    assert max(sides_m) == 0, "MAVProxy draws a circle of the largest, without looking at the flags"
    assert (one.navigational_status, one.type, one.callsign, one.name) == (15, 0, "", "")


@pytest.mark.parametrize(
    ("changes", "flags", "field", "value"),
    [
        ({"turn_rad_s": -math.inf}, 16 | 32, "turn_rate", -1),
        ({"turn_rad_s": math.radians(5.0)}, 16, "turn_rate", 126),
        ({"speed_m_s": 52.58}, 4 | 8, "velocity", 5258),
        ({"speed_m_s": 52.5}, 4, "velocity", 5250),
        ({"stern_m": 511, "starboard_m": 63, "port_m": 1}, 64, "dimension_stern", 511),
        ({"stern_m": 15, "starboard_m": 5}, 0, "dimension_stern", 0),
        ({"course_rad": math.tau - 1e-9}, 2, "COG", 0),
    ],
)  # fmt: skip
def test_limits_of_the_fields(changes: dict[str, Any], flags: int, field: str, value: int) -> None:
    one = decoded(replace(UNKNOWN, **changes))
    assert (one.flags, getattr(one, field)) == (flags, value)


class FakeAis:
    """A receiver with the vessels of the test."""

    def __init__(self) -> None:
        self.reading: AisReading | None = None

    def read(self) -> AisReading | None:
        return self.reading

    def close(self) -> None:
        """Nothing to let go."""


def test_a_boat_sends_its_vessels_and_tells_when_the_receiver_is_silent() -> None:
    ais = FakeAis()
    rig = Rig(ais=ais, config={"parts.ais.timeout_s": 5.0})
    rig.run(1.0)
    ais.reading = AisReading(rig.now_s, (FERRY, UNKNOWN))
    rig.run(1.0)
    assert [one.MMSI for one in rig.peer.said("AIS_VESSEL")] == [FERRY.mmsi, UNKNOWN.mmsi]
    rig.run(3.0)
    assert len(rig.peer.said("AIS_VESSEL")) == 2, "each once"
    rig.run(2.0)
    assert rig.boat.sensors.ais is None
    assert rig.peer.texts.count("AIS receiver is silent") == 1
    ais.reading = AisReading(rig.now_s, (replace(FERRY, time_s=rig.now_s),))
    rig.run(1.0)
    assert rig.peer.texts.count("AIS receiver measures again") == 1
    assert len(rig.peer.said("AIS_VESSEL")) == 3


def test_of_hundreds_of_vessels_the_boat_uses_the_nearest() -> None:
    ais = FakeAis()
    rig = Rig(ais=ais)
    rig.run(1.0)
    here = known(rig.boat.sensors.fix).position
    far = (replace(FERRY, mmsi=number, position=LatLon(51.0, -1.3)) for number in range(300))
    ais.reading = AisReading(rig.now_s, (replace(FERRY, position=here), *far))
    rig.run(0.2)
    vessels = known(rig.boat.sensors.ais).vessels
    assert (len(vessels), vessels[0].mmsi) == (100, FERRY.mmsi)


def test_a_new_report_is_sent_before_a_repetition_and_a_silent_vessel_every_half_minute() -> None:
    schedule, now_s = VesselSchedule(is_fitted=True), 0.0
    sent = list[tuple[float, int]]()
    reading = AisReading(0.0, (FERRY, UNKNOWN))
    for tick in range(240):
        now_s = 0.25 * tick
        assert schedule.has_due(now_s)
        sent += [(now_s, one.MMSI) for one in schedule.due(reading, now_s)]
        assert not schedule.has_due(now_s + 0.2)
        if tick == 20:
            reading = AisReading(0.0, (replace(FERRY, time_s=5.0), UNKNOWN))
    assert [(at_s, mmsi == 1) for at_s, mmsi in sent] == [
        (0.0, False), (0.25, True), (5.25, False), (30.25, True), (35.25, False)
    ]  # fmt: skip


def test_without_a_receiver_nobody_looks() -> None:
    assert not VesselSchedule(is_fitted=False).has_due(1e9)
