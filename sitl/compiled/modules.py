"""Which modules are compiled, and whether those that lie there still are what their sources say."""

import hashlib
import json
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[2]
# What msgspec reads from files must not be compiled: mypyc keeps of an annotation only its bare type, and the
# bounds that are in it would be lost.
READ_FROM_FILES: Final = frozenset(
    {
        "companion/router/status.py",
        "companion/sensors/gpsd.py",
        "companion/vehicle/track_record.py",
        "companion/vehicle/voyage_record.py",
    }
)
# mypyc drops the options of a msgspec struct's class line: without `frozen` and `kw_only` these do not import
NEEDS_CLASS_OPTIONS: Final = frozenset({"companion/failsafe/inputs.py"})
KERNEL: Final = "_"  # first letter of libraries that are built by pip and have twins (setup.py)
_MYPYC: Final = "__mypyc"  # in the name of the library with the code of all compiled modules
STAMP: Final = Path("build/compiled.json")  # sources and their digests, as they were compiled
PATTERNS: Final = (
    "companion/autopilot/pipeline.py",
    "companion/autopilot/sensor_suite.py",
    "companion/autopilot/snapshot.py",
    "companion/boat.py",
    "companion/control/*.py",
    "companion/core/geo.py",
    "companion/core/intent.py",
    "companion/core/modes.py",
    "companion/core/readings.py",
    "companion/core/state.py",
    "companion/core/status_text.py",
    "companion/core/units.py",
    "companion/estimation/*.py",
    "companion/failsafe/*.py",
    "companion/failsafe/*/*.py",
    "companion/geofence/*.py",
    "companion/guidance/*.py",
    "companion/links/memory.py",
    "companion/mavlink/address.py",
    "companion/mavlink/codec.py",
    "companion/mavlink/finder.py",
    "companion/mavlink/framing.py",
    "companion/obstacles/*/*.py",
    "companion/rc/*.py",
    "companion/router/*.py",
    "companion/sensors/*.py",
    "companion/services/endpoint.py",
    "companion/services/outbox.py",
    "companion/services/telemetry/*_messages.py",
    "companion/services/telemetry/heartbeat.py",
    "companion/services/telemetry/service.py",
    "companion/services/telemetry/statustext.py",
    "companion/services/telemetry/streams.py",
    "companion/vehicle/*.py",
    "companion/vehicle/*/*.py",
    "sitl/radio/channel.py",
    "sitl/run/recording/estimate_recorder.py",
    "sitl/run/lockstep.py",
    "sitl/run/program.py",
    "sitl/run/recording/recorder.py",
    "sitl/run/timeline.py",
    "sitl/world/contact.py",
    "sitl/world/drive/thruster.py",
    "sitl/world/electronics.py",
    "sitl/world/environment/*.py",
    "sitl/world/pack.py",
    "sitl/world/sensors/*.py",
    "sitl/world/hull.py",
    "sitl/world/windage.py",
    "sitl/world/world.py",
)
_PLAIN = ("__init__.py", "settings.py")


def sources(root: Path = ROOT) -> list[str]:
    """What is to be compiled, as paths below the root."""
    found = {path for pattern in PATTERNS for path in root.glob(pattern) if path.name not in _PLAIN}
    return sorted({str(path.relative_to(root)) for path in found} - READ_FROM_FILES - NEEDS_CLASS_OPTIONS)


def libraries(root: Path = ROOT) -> list[Path]:
    """The compiled modules that Python takes before their sources, and the library that holds their code."""
    found = {*root.glob(f"*{_MYPYC}*.so"), *root.glob("companion/**/*.so"), *root.glob("sitl/**/*.so")}
    return sorted(path for path in found if _MYPYC in path.name or not path.name.startswith(KERNEL))


def digests(root: Path = ROOT) -> dict[str, str]:
    """The sources as they are now."""
    return {name: hashlib.sha256((root / name).read_bytes()).hexdigest() for name in sources(root)}


def remember(root: Path = ROOT) -> None:
    """Note that what lies there was compiled from the sources of now."""
    stamp = root / STAMP
    stamp.parent.mkdir(exist_ok=True)
    stamp.write_text(json.dumps(digests(root), indent=0))


def stale(root: Path = ROOT) -> list[str]:
    """The sources that have changed since they were compiled; none where nothing is compiled."""
    if not libraries(root):
        return []
    stamp = root / STAMP
    before = json.loads(stamp.read_text()) if stamp.exists() else {}
    now = digests(root)
    return sorted(name for name in before.keys() | now.keys() if before.get(name) != now.get(name))


def remove(root: Path = ROOT) -> None:
    """Back to the sources."""
    for library in libraries(root):
        library.unlink()
    (root / STAMP).unlink(missing_ok=True)
