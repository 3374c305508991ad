"""The HTML page: whole in itself, with the route's figures, and safe with any name."""

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.assembly.timetable import Timetable, Tried
from mission_tools.costs.departure import posix_s
from mission_tools.drawing.html import compose, itinerary
from mission_tools.maps import Chart, Feature, build_chart
from mission_tools.mission.mission import Mission, MissionItem

FRAME = LocalFrame(LatLon(50.0, -1.2))
PATH = [Point(0.0, 0.0), Point(0.0, 100.0), Point(62.0, 180.0)]
ISLE = shapely.box(40, -30, 60, -8)  # 8 m south of the first leg


def chart(name: str = "Lake") -> Chart:
    features = [
        Feature("Goose <Island>", "island", ISLE),
        Feature("Beach", "swimming", shapely.box(-90, 60, -40, 90)),
    ]
    return build_chart(name, FRAME, shapely.box(-100, -50, 250, 100), features)


def planned(on: Chart, *, speed_m_s: float | None = None, hold_s: float = 0.0) -> PlannedMission:
    home, *stops = (FRAME.to_global(at) for at in PATH)
    items = tuple(MissionItem.at(place, params=(hold_s, 0.0, 0.0, 0.0)) for place in stops)
    mission = Mission(items, home=home)
    if speed_m_s is not None:
        mission = mission.at_speed(speed_m_s)
    return PlannedMission(on.name, mission, on, notes=("one & two",))


class Page(HTMLParser):
    """Elements, attributes, and the text of cells."""

    void = frozenset({"meta", "br", "line", "rect"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.cells: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        if tag == "td":
            self.cells.append("")
        if tag not in self.void:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "td" in self.open:
            self.cells[-1] += data

    def of(self, tag: str) -> Iterator[dict[str, str | None]]:
        return (attributes for name, attributes in self.found if name == tag)


def test_the_page_needs_nothing_else() -> None:
    text = compose(planned(chart()))
    page = Page(text)
    assert page.open == []
    assert not any({"src", "href", "srcset", "data"} & attributes.keys() for _, attributes in page.found)
    assert not {"link", "img", "iframe", "object", "base"} & {tag for tag, _ in page.found}
    assert "default-src 'none'" in next(a["content"] or "" for a in page.of("meta") if "http-equiv" in a)
    assert not re.search(r"https?://|url\((?!#)|@import|fetch\(|XMLHttpRequest|WebSocket", text)


def test_the_itinerary_counts_holds_and_names_the_worst_places_once() -> None:
    way = itinerary(planned(chart(), speed_m_s=2.0, hold_s=10.0))
    assert way.length_m == pytest.approx(201.21, abs=0.01)
    assert way.duration_s == pytest.approx(120.61, abs=0.01)
    assert not way.is_assumed
    worst = way.worst(3)
    assert worst[0].clearance_m == pytest.approx(8.0, abs=0.01)
    assert 39.9 <= worst[0].worst.east_m <= 60.1
    assert itinerary(planned(chart())).is_assumed


def test_in_a_current_the_legs_have_their_times_and_the_departures_their_bars() -> None:
    noon_s = posix_s("2026-06-01T12:00Z")
    tried = (Tried(noon_s, noon_s + 90.0, 90.0), Tried(noon_s + 60.0, math.inf, math.inf))
    table = Timetable(noon_s, (noon_s + 50.0, noon_s + 90.0), is_dated=True, tried=tried)
    page = Page(text := compose(replace(planned(chart(), speed_m_s=2.0), timetable=table)))
    assert page.open == []
    assert [cell for cell in page.cells if cell.endswith("Z")] == ["50 s, 12:00:50Z", "1 min 30 s, 12:01:30Z"]
    assert (
        text.count('<path d="M0.00 30v-30.00h40.00V30z" class=best><title>2026-06-01 12:00Z, 1 min 30 s<')
        == 1
    )
    assert "2026-06-01 12:00Z, 1 min 30 s … 2026-06-01 12:01Z, cannot be sailed" in text
    assert "<b>1 min 30 s</b> under way" in text
    assert "Departures" not in compose(planned(chart()))


def test_names_are_text_and_nothing_else() -> None:
    nasty = '</title><script>alert(1)</script>${title}"'
    page = Page(compose(planned(chart(nasty))))
    assert sum(1 for _ in page.of("script")) == 1
