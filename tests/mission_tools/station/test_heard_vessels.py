"""The vessels of a boat's AIS_VESSEL messages, as the page gets them."""

import pytest
from blank_messages import blank

from companion.mavlink.dialect import dialect
from mission_tools.station.messages import Place, Vessel
from mission_tools.station.view import HANDLERS, View

KNOWN = 2 | 4 | 64 | 4096


def told(view: View, **values: object) -> None:
    fields = {
        "MMSI": 235_001_234,
        "lat": 507_600_000,
        "lon": -13_000_000,
        "callsign": b"",
        "name": b"RED FALCON",
    }
    fields |= {"COG": 12_340, "heading": 12_000, "velocity": 1000, "dimension_bow": 60, "dimension_stern": 33}
    fields |= {"flags": KNOWN, **values}
    HANDLERS[dialect.MAVLINK_MSG_ID_AIS_VESSEL](view, blank("ais_vessel", **fields))


def at(view: View, boot_ms: int) -> dict[str, Vessel]:
    view.boot_ms = boot_ms
    return view.vessels


def test_a_vessel_has_what_its_flags_say_is_known() -> None:
    view = View()
    told(view)
    place = Place(lat=50.76, lon=-1.3)
    assert view.vessels == {
        "235001234": Vessel(
            name="RED FALCON", place=place, course_deg=123.4, heading_deg=120.0, speed_m_s=10.0, length_m=93
        )
    }
    told(view, flags=0, heading=65535)
    assert view.vessels == {"235001234": Vessel(name="235001234", place=place)}
    told(view, heading=65535)
    assert view.vessels["235001234"].heading_deg == 123.4
    told(view, heading=65535, velocity=103)
    assert view.vessels["235001234"].heading_deg == 123.4
    told(view, heading=65535, velocity=102)
    assert view.vessels["235001234"].heading_deg is None, "at rest the course is noise"


@pytest.mark.parametrize("values", [{"lat": 0x7FFFFFFF}, {"lon": 0x7FFFFFFF}])
def test_a_vessel_without_a_place_is_not_shown(values: dict[str, int]) -> None:
    view = View()
    told(view, **values)
    assert view.vessels == {}


def test_a_vessel_goes_when_the_boat_tells_no_more_of_it_or_starts_anew() -> None:
    view = View()
    view.boot_ms = 10_000
    told(view)
    assert at(view, 100_000)
    assert not at(view, 100_001)
    told(view)
    assert not at(view, 50_000)


def test_of_many_vessels_the_latest_hundred_are_kept_and_their_names_are_one_line() -> None:
    view = View()
    for number in range(150):
        told(view, MMSI=number, name=b"A\nB\x07")
    assert sorted(view.vessels) == [f"{number:09d}" for number in range(50, 150)]
    assert "\n" not in view.vessels["000000149"].name
