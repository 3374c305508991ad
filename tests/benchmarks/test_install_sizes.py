"""The script that adds up what an installation downloads and takes up."""

import zipfile
from pathlib import Path

import pytest

from benchmarks.install import Wheel, extras, platforms, read_wheel, without_a_wheel


def wheel(package: str, tags: str) -> Wheel:
    return Wheel(package, tags, 1, 2)


def test_a_wheels_sizes_are_those_of_the_file_and_of_its_contents(tmp_path: Path) -> None:
    path = tmp_path / "Py_Thing-1.2-cp311-cp311-manylinux2014_aarch64.manylinux_2_17_aarch64.whl"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("thing/__init__.py", "x = 1\n" * 1000)
        archive.writestr("thing-1.2.dist-info/METADATA", "Name: thing\n")
    found = read_wheel(path)
    assert (found.package, found.tags) == ("py-thing", "manylinux2014_aarch64.manylinux_2_17_aarch64")
    assert found.unpacked == 6000 + 12
    assert found.download == path.stat().st_size < 1000


def test_packages_without_a_32_bit_wheel_are_named_in_order() -> None:
    wheels = [
        wheel("pymavlink", "manylinux_2_17_aarch64"),
        wheel("rich", "any"),
        wheel("lxml", "manylinux_2_31_armv7l"),
        wheel("msgspec", "manylinux_2_17_aarch64"),
    ]
    assert without_a_wheel(wheels, "armv7l") == ["msgspec", "pymavlink"]


def test_a_new_package_without_a_wheel_is_an_error() -> None:
    with pytest.raises(LookupError, match="no wheel for armv7l: numpy"):
        without_a_wheel([wheel("numpy", "manylinux_2_28_aarch64")], "armv7l")


def test_wheels_of_the_machine_itself_come_before_their_stand_ins() -> None:
    assert all(tag.endswith("aarch64") for tag in platforms("aarch64"))
    tags = platforms("armv7l")
    first = tags.index(platforms("aarch64")[0])
    assert all(tag.endswith("armv7l") for tag in tags[:first])
    assert tags[first:] == platforms("aarch64")


def test_the_extras_of_a_boat_and_a_planner_are_measured_and_those_for_development_are_not() -> None:
    assert set(extras()) >= {"pi", "planner", "sitl", "maps", "cluster", "parquet", "all"}
    assert not set(extras()) & {"dev", "bench", "fuzz", "peers"}
