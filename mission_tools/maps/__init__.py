"""Maps from wherever they come: one loader per source, one `Chart` out of all of them."""

from mission_tools.maps.catalogue import load_source, scenario_names
from mission_tools.maps.chart import Chart, Feature, build_chart
from mission_tools.maps.geojson import load_geojson
from mission_tools.maps.map_files import load_map
from mission_tools.maps.source import RouteDefaults, Source

__all__ = [
    "Chart",
    "Feature",
    "RouteDefaults",
    "Source",
    "build_chart",
    "load_geojson",
    "load_map",
    "load_source",
    "scenario_names",
]
