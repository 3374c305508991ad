"""Routes of other programs as missions: by the shape of their files, and by files that GDAL wrote."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, distance_m
from mission_tools.errors import MapError, PlanFileError
from mission_tools.files.drawn import MOST_BYTES, THINNED_ABOVE, THINNED_M, DrawnMission, load_drawn
from mission_tools.files.written import save_route
from mission_tools.geojson import collection, feature
from mission_tools.mission.mission import Fence, FencePolygon, Mission, MissionItem, Rally

LINE = [(-1.2027, 49.9986), (-1.2015, 49.9993), (-1.2, 50.0005)]

QGROUNDCONTROL = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2">
 <Document>
  <name>QGroundControl Plan KML</name>
  <Style id="MissionLineStyle"><LineStyle><color>ff2f2fbe</color><width>4</width></LineStyle></Style>
  <Folder><name>Items</name>
   <Placemark><name>1 </name><styleUrl>#BalloonStyle</styleUrl>
    <description><![CDATA[Index: 1
Waypoint
]]></description>
    <Point><altitudeMode>absolute</altitudeMode><coordinates>-1.2015,49.9993,50</coordinates><extrude>1</extrude></Point>
   </Placemark>
  </Folder>
  <Placemark><styleUrl>#MissionLineStyle</styleUrl><name>Flight Path</name><visibility>1</visibility>
   <LookAt><latitude>49.9986</latitude><longitude>-1.2027</longitude></LookAt>
   <LineString><extruder>1</extruder><tessellate>1</tessellate><altitudeMode>absolute</altitudeMode>
   <coordinates>-1.2027,49.9986,0.00
-1.2015,49.9993,50.00
-1.2,50.0005,50.00
</coordinates></LineString></Placemark>
  <Placemark><name>Survey</name><Polygon><outerBoundaryIs><LinearRing>
   <coordinates>-1.21,50,0 -1.20,50,0 -1.20,50.01,0 -1.21,50,0</coordinates>
   </LinearRing></outerBoundaryIs></Polygon>
  </Placemark>
 </Document>
</kml>
"""
GARMIN = """<?xml version="1.0" encoding="UTF-8" standalone="no" ?>
<gpx xmlns="http://www.topografix.com/GPX/1/1" xmlns:gpxx="http://www.garmin.com/xmlschemas/GpxExtensions/v3"
 creator="BaseCamp" version="1.1" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
 <metadata><link href="http://www.garmin.com"><text>Garmin International</text></link></metadata>
 <wpt lat="50.3" lon="-1.3"><name>Home</name><sym>Marina</sym></wpt>
 <rte><name>Pond</name>
  <extensions><gpxx:RouteExtension><gpxx:IsAutoNamed>true</gpxx:IsAutoNamed></gpxx:RouteExtension></extensions>
  <rtept lat="49.9986" lon="-1.2027"><name>Home</name><sym>Marina</sym></rtept>
  <rtept lat="49.9993" lon="-1.2015"><time>2026-11-01T10:00:00Z</time><name>A</name>
   <extensions><gpxx:RoutePointExtension><gpxx:rpt lat="49.9999" lon="-1.2007"/>
   </gpxx:RoutePointExtension></extensions>
  </rtept>
  <rtept lat="50.0005" lon="-1.2"><name>B</name></rtept>
 </rte>
 <trk><name>old</name><trkseg><trkpt lat="51" lon="-1"/><trkpt lat="51.1" lon="-1"/></trkseg></trk>
</gpx>
"""
EARTH_TRACK = """<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2">
<Placemark><gx:Track><when>2026-11-01T10:00:00Z</when><when>2026-11-01T10:00:05Z</when>
<when>2026-11-01T10:00:09Z</when>
<gx:coord>-1.2027 49.9986 12.1</gx:coord><gx:coord>-1.2015 49.9993 12</gx:coord>
<gx:coord>-1.2 50.0005 12</gx:coord>
</gx:Track></Placemark></kml>"""
GEOJSON_IO = collection([feature("LineString", LINE) | {"id": 0}])


def load(tmp_path: Path, name: str, content: object) -> DrawnMission:
    """What is read from a file of this content."""
    path = tmp_path / name
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return load_drawn(path)


def places(drawn: DrawnMission) -> list[tuple[float, float]]:
    """Longitude and latitude of each waypoint."""
    return [(place.lon_deg, place.lat_deg) for place in drawn.mission.places]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("qgc.kml", QGROUNDCONTROL),
        ("garmin.gpx", GARMIN),
        ("earth.kml", EARTH_TRACK),
        ("drawn.geojson", GEOJSON_IO),
        ("bare.json", GEOJSON_IO["features"][0]["geometry"]),
        ("one.geojson", GEOJSON_IO["features"][0]),
        ("old.gpx", GARMIN.replace("/GPX/1/1", "/GPX/1/0")),
    ],
)
def test_the_route_of_a_program_becomes_waypoints(name: str, content: object, tmp_path: Path) -> None:
    drawn = load(tmp_path, name, content)
    assert places(drawn) == [pytest.approx(at, abs=1e-7) for at in LINE]
    assert all(item.command == 16 and item.hold_s == 0.0 for item in drawn.mission.items)
    assert drawn.mission.home is None
    assert drawn.notes == ()


@pytest.mark.filterwarnings("ignore")  # of GDAL, on files without fields
@pytest.mark.parametrize(("suffix", "driver"), [(".gpx", "GPX"), (".kml", "KML"), (".geojson", "GeoJSON")])
def test_lines_that_gdal_wrote_are_read(suffix: str, driver: str, tmp_path: Path) -> None:
    pyogrio = pytest.importorskip("pyogrio", reason="the extra maps is not installed")
    path = tmp_path / f"line{suffix}"
    shapes = np.array([shapely.to_wkb(shapely.LineString(LINE))], dtype=object)
    pyogrio.raw.write(
        path, shapes, [np.array(["one"], dtype=object)], ["name"], driver=driver, geometry_type="LineString",
        crs="EPSG:4326",
    )  # fmt: skip
    assert places(load_drawn(path)) == [pytest.approx(at, abs=1e-7) for at in LINE]


def test_points_without_a_line_are_sailed_in_their_order(tmp_path: Path) -> None:
    points = "".join(f'<wpt lat="{lat}" lon="{lon}"/>' for lon, lat in LINE)
    assert places(load(tmp_path, "p.gpx", f"<gpx>{points}</gpx>")) == LINE
    features = [
        {"type": "Feature", "properties": None, "geometry": {"type": "Point", "coordinates": [*at, 3.0]}}
        for at in LINE
    ]
    assert places(load(tmp_path, "p.geojson", {"type": "FeatureCollection", "features": features})) == LINE


def test_several_lines_are_sailed_one_after_the_other_and_it_is_said(tmp_path: Path) -> None:
    segments = "".join(f'<trkseg><trkpt lat="{lat}" lon="{lon}"/></trkseg>' for lon, lat in LINE)
    drawn = load(tmp_path, "t.gpx", f"<gpx><trk>{segments}</trk></gpx>")
    assert places(drawn) == LINE
    assert drawn.notes == ("3 lines, sailed one after the other",)


def test_a_long_track_is_thinned_and_stays_within_a_metre(tmp_path: Path) -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 4 * THINNED_ABOVE)
    track = [(-1.2 + 0.002 * float(np.sin(a)), 50.0 + 0.001 * float(np.sin(2 * a))) for a in angles]
    points = "".join(f'<trkpt lat="{lat:.7f}" lon="{lon:.7f}"/>' for lon, lat in track)
    drawn = load(tmp_path, "t.gpx", f"<gpx><trk><trkseg>{points}</trkseg></trk></gpx>")
    assert 10 < len(drawn.mission.items) < 200
    assert "2000 points" in drawn.notes[0]
    frame = LocalFrame(LatLon(50.0, -1.2))
    line = shapely.LineString([frame.to_local(place) for place in drawn.mission.places])
    assert all(
        line.distance(shapely.Point(frame.to_local(LatLon(lat, lon)))) <= THINNED_M + 0.02
        for lon, lat in track
    )


def test_a_place_twice_in_a_row_is_one_waypoint(tmp_path: Path) -> None:
    line = {"type": "LineString", "coordinates": [LINE[0], LINE[0], LINE[1], LINE[1], LINE[0]]}
    drawn = load(tmp_path, "t.geojson", line)
    assert places(drawn) == [LINE[0], LINE[1], LINE[0]]
    frame = LocalFrame(LatLon(50.0, -1.2))
    assert all(
        distance_m(frame.to_local(a), frame.to_local(b)) > 1.0 for a, b in pairwise(drawn.mission.places)
    )


@pytest.mark.parametrize("suffix", [".gpx", ".kml", ".geojson"])
def test_what_this_package_wrote_keeps_its_home_and_leaves_its_fence_aside(
    suffix: str, tmp_path: Path
) -> None:
    corners = (LatLon(49.99, -1.21), LatLon(49.99, -1.19), LatLon(50.01, -1.2))
    items = tuple(MissionItem.at(LatLon(lat, lon)) for lon, lat in LINE[1:])
    home = LatLon(LINE[0][1], LINE[0][0])
    mission = Mission(items, home, fence=Fence((FencePolygon(corners),)), rally=(Rally(corners[0]),))
    path = tmp_path / f"own{suffix}"
    save_route(mission, path)
    drawn = load_drawn(path)
    assert (drawn.mission.home, drawn.mission.items) == (home, items)
    assert drawn.mission.fence == Fence()


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("x.gpx", '<!DOCTYPE g [<!ENTITY a "b">]><gpx><wpt lat="&a;" lon="1"/></gpx>', "DOCTYPE"),
        ("x.gpx", "<kml/>", "not GPX"),
        ("x.gpx", '<gpx><rte><rtept lat="91" lon="1"/></rte></gpx>', "out of range"),
        ("x.gpx", '<gpx><rte><rtept lat="nan" lon="1"/></rte></gpx>', "point 1"),
        ("x.gpx", '<gpx><rte><rtept lat="" lon="1"/></rte></gpx>', "lat and lon"),
        ("x.gpx", "<gpx/>", "no route"),
        ("x.kml", "<gpx/>", "not KML"),
        ("x.kml", "<kml><Placemark><Point><coordinates>1;2</coordinates></Point></Placemark></kml>",
         "lon,lat"),
        ("x.kml", "<kml>" + "<Folder>" * 200, "too deep"),
        ("x.geojson", {"type": "Polygon", "coordinates": [[[0, 0], [0, 1], [1, 1], [0, 0]]]}, "no route"),
        ("x.geojson", {"type": "LineString", "coordinates": [1, 2]}, "expected"),
        ("x.geojson", {"type": "MultiLineString", "coordinates": [1]}, "expected positions"),
        ("x.geojson", {"type": "LineString", "coordinates": "north"}, "expected coordinates"),
        ("x.geojson", "[1, 2", "not JSON"),
        ("x.xml", "<gpx/>", "expected .gpx"),
    ],
)  # fmt: skip
def test_a_file_without_a_route_is_refused_in_a_line(
    name: str, content: object, said: str, tmp_path: Path
) -> None:
    with pytest.raises((PlanFileError, MapError), match=said) as refused:
        load(tmp_path, name, content)
    assert str(refused.value).startswith(str(tmp_path / name))
    assert "\n" not in str(refused.value)


def test_a_huge_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "x.gpx"
    with path.open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    with pytest.raises(PlanFileError, match="more than 20 MB"):
        load_drawn(path)
