"""The extra `pi`: what a Pi installs is what was tested here, and it loads."""

import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
REQUIRED = [Requirement(line) for line in PROJECT["optional-dependencies"]["pi"]]
PACKAGES = [need.name for need in REQUIRED if need.marker is None or need.marker.evaluate()]
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
