"""boat-companion needs only the base of pyproject.toml; the other programs name the extra that they need."""

import ast
import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]
MODULES = {"pillow": "PIL", "pyserial": "serial"}  # where the module is not named as its package
# Makes every module of the extras (argument 1) missing, then runs a module's main()
WITHOUT = """
import importlib, importlib.abc, sys
class Missing(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in blocked:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
blocked = set(sys.argv[1].split(","))
sys.meta_path.insert(0, Missing())
module = sys.argv[2]
sys.argv = sys.argv[3:]
importlib.import_module(module).main()
"""


def packages(requirements: list[str]) -> set[str]:
    names = {re.split(r"[\[><=; ]", requirement)[0] for requirement in requirements} - {"mavboat"}
    return {MODULES.get(name, name) for name in names}


BASE = packages(PROJECT["dependencies"])
OF_EXTRAS = packages(
    [one for name in EXTRAS["all"][0][len("mavboat[") : -1].split(",") for one in EXTRAS[name]]
)


def run_without_extras(module: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", WITHOUT, ",".join(sorted(OF_EXTRAS)), module, *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        cwd=ROOT,
    )


def imported_packages(folder: Path) -> Iterator[tuple[Path, str]]:
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                yield from ((path, name.name.partition(".")[0]) for name in node.names)
            elif isinstance(node, ast.ImportFrom):
                yield path, (node.module or "").partition(".")[0]


def test_the_companion_imports_exactly_the_base() -> None:
    """gpiozero, lgpio and smbus2 are loaded by name where a part needs them (`import_optional`)."""
    found = {name for _, name in imported_packages(ROOT / "companion")}
    assert found - set(sys.stdlib_module_names) - {"companion"} == BASE


def test_the_page_imports_of_others_only_its_extra_and_the_base() -> None:
    rooms = [ROOT / "mission_tools" / room for room in ("shore", "station")]
    found = {name for room in rooms for _, name in imported_packages(room)}
    assert found - set(sys.stdlib_module_names) - {"companion", "mission_tools"} - BASE == packages(
        EXTRAS["web"]
    )


@pytest.mark.parametrize(
    ("module", "extra", "arguments"),
    [
        ("mission_tools.shore.__main__", "web", ("boat-shore",)),
        ("sitl.__main__", "sitl", ("boat-sitl", "sail", "pool")),
        ("mission_tools.cli.plan", "planner", ("mission-plan", "lake")),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_a_program_without_its_extra_names_it_in_one_line(
    module: str, extra: str, arguments: tuple[str, ...]
) -> None:
    done = run_without_extras(module, *arguments, "--json")
    assert done.returncode == 2
    assert done.stderr.startswith(f"{arguments[0]}: needs the extra '{extra}' (no module ")
    assert f"): pip install '.[{extra}]' in a clone of mavboat" in done.stderr
    assert done.stderr.count("\n") == 1
    assert json.loads(done.stdout)["exit_code"] == 2
