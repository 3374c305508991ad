"""What a plain map does not need is not imported: each of these takes a tenth of a second or more."""

import subprocess
import sys
from pathlib import Path

POND = Path(__file__).parents[3] / "examples" / "maps" / "mill_pond.geojson"
HEAVY = {"pyproj", "scipy", "matplotlib", "pyogrio", "PIL", "contourpy", "mavsdk", "msgspec"}


def test_reading_a_geojson_map_imports_numpy_and_shapely_alone() -> None:
    code = f"""
import sys
from mission_tools.maps import load_source
load_source({str(POND)!r})
print(*sorted({HEAVY!r} & sys.modules.keys()))
"""
    ran = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert ran.stdout.strip() == ""


def test_a_kml_map_in_degrees_needs_no_more(tmp_path: Path) -> None:
    path = tmp_path / "lake.kml"
    ring = "10,50 10.1,50 10.1,50.1 10,50.1 10,50"
    path.write_text(
        "<kml><Placemark><Polygon><outerBoundaryIs><LinearRing><coordinates>"
        f"{ring}</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></kml>"
    )
    code = f"""
import sys
from mission_tools.maps import load_source
load_source({str(path)!r})
print(*sorted({HEAVY!r} & sys.modules.keys()))
"""
    ran = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert ran.stdout.strip() == ""
