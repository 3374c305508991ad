"""Compiled modules: never older than their sources, and the same to the byte."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from sitl.compiled.modules import ROOT, libraries, remember, remove, stale

pytestmark = pytest.mark.slow

_SAIL = """
from sitl.compiled.modules import libraries
from sitl.cli.arguments import scenario_from
from sitl.courses.courses import course_mission
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun

SETTINGS = (
    ["environment.current_m_s=0.4"],
    ["environment.wind_m_s=6"],
    ["sensors.gnss.noise_m=0.5", "link.delay_s=0.2"],
)
print(len(libraries()))
for settings in SETTINGS:
    scenario = scenario_from("open", settings, None, 3, None)
    items = wire_items(course_mission("zigzag", scenario.frame, scenario.start))
    print(MissionRun(scenario, items).run(40.0).state_hash)
"""


_BUILD = """
import sys
from sitl.compiled import __main__, modules

modules.PATTERNS = ("companion/core/units.py", "companion/core/geo.py")
sys.exit(__main__.main(["build"]))
"""
# As `pip install --editable` has it: the packages are mapped, and nothing beside them
_IMPORT = """
import sys

finder = next(module for name, module in sys.modules.items() if name.startswith("__editable___mavboat"))
finder.MAPPING["companion"] = sys.argv[1]
from companion.core import geo, units

print(geo.__file__, units.wrap_two_pi(-1.0))
"""


def house(tmp_path: Path) -> Path:
    """A few sources, and something compiled beside one."""
    for name in ("companion/core/geo.py", "companion/core/units.py", "sitl/world/world.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("HERE = 1\n")
    (tmp_path / "companion/core/geo.so").touch()
    (tmp_path / "companion/_compiled__mypyc.so").touch()
    return tmp_path


def test_a_source_that_has_changed_or_gone_or_come_is_named(tmp_path: Path) -> None:
    root = house(tmp_path)
    assert len(stale(root)) == 3
    remember(root)
    assert stale(root) == []
    (root / "companion/core/geo.py").write_text("HERE = 2\n")
    (root / "sitl/world/world.py").unlink()
    (root / "sitl/world/hull.py").write_text("HERE = 3\n")
    assert stale(root) == ["companion/core/geo.py", "sitl/world/hull.py", "sitl/world/world.py"]
    kernel = root / "companion/planning/_segments.so"
    kernel.parent.mkdir()
    kernel.touch()
    remove(root)
    assert libraries(root) == []
    assert kernel.exists()


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
@pytest.mark.skipif(
    not any(name.startswith("__editable___mavboat") for name in sys.modules),
    reason="the packages are not installed in place",
)
def test_compiled_modules_are_found_by_programs_that_start_in_another_folder(tmp_path: Path) -> None:
    root, elsewhere = tmp_path / "house", tmp_path / "elsewhere"
    elsewhere.mkdir()
    for package in ("companion", "sitl"):
        shutil.copytree(ROOT / package, root / package, ignore=shutil.ignore_patterns("*.so"))
    shutil.copy(ROOT / "pyproject.toml", root)
    subprocess.run([sys.executable, "-c", _BUILD], cwd=root, check=True, capture_output=True)
    done = subprocess.run(
        [sys.executable, "-c", _IMPORT, str(root / "companion")],
        cwd=elsewhere,
        check=True,
        capture_output=True,
        text=True,
    )
    file, value = done.stdout.split()
    assert file.endswith(".so")
    assert float(value) == pytest.approx(5.283185307)
    assert not list(root.glob("*.so")), "a library lies outside the packages"
    remove(root)
    assert not list(root.glob("companion/**/*.so"))


@pytest.mark.skipif(not libraries(), reason="nothing is compiled: make fast")
def test_a_run_is_the_same_to_the_byte_compiled_or_not(tmp_path: Path) -> None:
    assert stale() == []
    for package in ("companion", "sitl"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("*.so"))
    fast, slow = (_sail(root) for root in (ROOT, tmp_path))
    assert int(fast[0]) > 0
    assert int(slow[0]) == 0
    assert fast[1:] == slow[1:]


def _sail(root: Path) -> list[str]:
    command = [sys.executable, "-c", _SAIL]
    return subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout.split()
