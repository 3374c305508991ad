"""Where the data of the tests lies; tests/data/README.md says where each file came from."""

from pathlib import Path

_DATA = Path(__file__).parents[1] / "data"
SHORES = _DATA / "shores"
GRIDS = _DATA / "grids"
RECORDINGS = sorted((_DATA / "recordings").glob("*.tlog"))
ROVER = _DATA / "autopilot" / "rover-4.7-dev.tlog"
