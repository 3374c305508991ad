"""The extra `pi`: what a Pi installs is what was tested here, and it loads."""

import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from patience import JOB_S

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
REQUIRED = [Requirement(line) for line in PROJECT["optional-dependencies"]["pi"]]
PACKAGES = [need.name for need in REQUIRED if need.marker is None or need.marker.evaluate()]
UNPINNED = {"setuptools"}  # of colorzero, which asks for any; an environment's own is left alone
PINS = dict(
    line.split("==")
    for line in (ROOT / "constraints.txt").read_text(encoding="utf-8").split()
    if "==" in line
)


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_of_the_pi_is_pinned_and_installed_as_pinned(package: str) -> None:
    assert metadata.version(package) == PINS[package]


def test_each_python_of_raspberry_pi_os_gets_lgpio_once() -> None:
    """On 64 bits; a 32-bit Python 3.13 takes that of the system."""
    for version in ("3.11", "3.13"):
        here = {"python_version": version, "platform_machine": "aarch64"}
        wanted = [need.name for need in REQUIRED if need.marker is None or need.marker.evaluate(here)]
        assert len([name for name in wanted if name.endswith("lgpio")]) == 1


def test_all_that_the_packages_of_the_pi_need_is_pinned_too() -> None:
    """No package may bring along what nobody has tested, nor load what it does not bring along."""
    todo, seen = list(PACKAGES), set[str]()
    while todo:
        package = todo.pop()
        if package in seen | UNPINNED:
            continue
        seen.add(package)
        assert package in PINS, f"{package} is not pinned"
        needs = [Requirement(line) for line in metadata.requires(package) or []]
        todo += [need.name for need in needs if need.marker is None or need.marker.evaluate({"extra": ""})]


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_of_the_pi_loads_in_a_folder_of_its_users(package: str, tmp_path: Path) -> None:
    load = [sys.executable, "-c", f"import {package}"]
    subprocess.run(load, cwd=tmp_path, check=True, timeout=JOB_S)
