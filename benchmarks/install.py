"""What an installation on a Raspberry Pi downloads and takes up: wheels only, for the base and each extra.

pip resolves a wheel of this project, with the tested versions of constraints.txt, for 64-bit and 32-bit
Raspberry Pi OS. Where a package has no wheel for 32 bits, its 64-bit wheel stands in for the size, and the
row names it; any such package that is not in NO_32_BIT_WHEEL is an error. pip runs as if on that machine, on
an interpreter of each Python version, which must be on the path: it evaluates markers for where it runs.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from benchmarks.measure import Row, alone

PYTHONS = ("3.11", "3.13")  # of Raspberry Pi OS Bookworm and Trixie
NOT_FOR_THE_BOAT = frozenset({"bench", "dev", "fuzz", "peers"})
# Source distributions on the ordinary index
NO_32_BIT_WHEEL = frozenset({"msgspec", "pymavlink"})
_GLIBC = (36, 35, 34, 31, 28, 27, 26, 24, 17)  # minor versions of manylinux tags, up to Bookworm's glibc 2.36
_CACHE = Path("out/install")
_PIP = """
import platform, runpy, sys
machine = sys.argv.pop(1)
platform.machine = lambda: machine
runpy.run_module("pip", run_name="__main__")
"""


@dataclass(frozen=True)
class Wheel:
    """A wheel. The sizes are in bytes; unpacked without Python's caches."""

    package: str
    tags: str  # of the platforms, such as manylinux_2_17_aarch64
    download: int
    unpacked: int


def rows() -> list[Row]:
    """Base and extras on 64 bits, the base and `pi` on 32 bits."""
    with tempfile.TemporaryDirectory() as folder:
        wheel = _build(Path(folder))
        found = []
        for python in PYTHONS:
            if not _runs(python):
                found.append(
                    alone(f"Python {python}", "MB", "less", [math.nan], "no interpreter: not measured")
                )
                continue
            found += [_row(wheel, extra, "aarch64", python) for extra in ("", *extras())]
            found += [_row(wheel, extra, "armv7l", python) for extra in ("", "pi")]
        return found


def extras() -> tuple[str, ...]:
    """The extras of pyproject.toml that are not for development."""
    project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
    return tuple(name for name in project["optional-dependencies"] if name not in NOT_FOR_THE_BOAT)


def platforms(machine: str) -> list[str]:
    """The platform tags that a machine accepts, the newest first; 64-bit tags stand in for 32-bit ones."""
    tags = [f"manylinux_2_{minor}_{machine}" for minor in _GLIBC] + [
        f"manylinux2014_{machine}",
        f"linux_{machine}",
    ]
    return tags if machine == "aarch64" else tags + platforms("aarch64")


def read_wheel(path: Path) -> Wheel:
    """Its name, tags and sizes."""
    name, *_, tags = path.stem.split("-")
    with zipfile.ZipFile(path) as archive:
        unpacked = sum(entry.file_size for entry in archive.infolist())
    return Wheel(name.lower().replace("_", "-"), tags, path.stat().st_size, unpacked)


def without_a_wheel(wheels: Iterable[Wheel], machine: str) -> list[str]:
    """Packages that have none for the machine, in order.

    Raises:
        LookupError: one of them is not known to have none.
    """
    names = sorted(wheel.package for wheel in wheels if wheel.tags != "any" and machine not in wheel.tags)
    unknown = sorted(set(names) - NO_32_BIT_WHEEL)
    if unknown:
        raise LookupError(f"no wheel for {machine}: {', '.join(unknown)}")
    return names


def _runs(python: str) -> bool:
    try:
        return subprocess.run([f"python{python}", "-V"], capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def _build(folder: Path) -> Path:
    environment = os.environ | {"MAVBOAT_PURE": "1"}
    command = ["wheel", "--no-deps", "--wheel-dir", str(folder), "."]
    subprocess.run([sys.executable, "-m", "pip", "--quiet", *command], check=True, env=environment)
    (wheel,) = folder.glob("*.whl")
    return wheel


def _row(wheel: Path, extra: str, machine: str, python: str) -> Row:
    wheels = _download(f"{wheel}[{extra}]" if extra else str(wheel), machine, python)
    source = without_a_wheel(wheels, machine)
    note = f"{len(wheels)} packages, {sum(one.download for one in wheels) / 1e6:.0f} MB to download"
    if source:
        note += f"; no 32-bit wheel: {', '.join(source)}"
    size_mb = sum(one.unpacked for one in wheels) / 1e6
    return alone(f"{extra or 'base'}, {machine}, Python {python}", "MB", "less", [size_mb], note)


def _download(requirement: str, machine: str, python: str) -> list[Wheel]:
    """The wheels that pip chooses, this project's included."""
    folder = _CACHE / f"{machine}-{python}"
    folder.mkdir(parents=True, exist_ok=True)
    accepted = ["--only-binary=:all:", "--implementation", "cp", "--python-version", python]
    accepted += [word for tag in platforms(machine) for word in ("--platform", tag)]
    pip = [f"python{python}", "-c", _PIP, machine, "--quiet", "--disable-pip-version-check"]
    report = ["--dry-run", "--ignore-installed", "--target", str(folder / "none"), "--report", "-"]
    resolve = [*pip, "install", *report, *accepted, "-c", "constraints.txt", requirement]
    answer = subprocess.run(resolve, check=True, capture_output=True)
    urls = [item["download_info"]["url"] for item in json.loads(answer.stdout)["install"]]
    missing = [url for url in urls if not (folder / _name(url)).exists()]
    if missing:
        subprocess.run(
            [*pip, "download", "--no-deps", "--dest", str(folder), *accepted, *missing], check=True
        )
    return [read_wheel(folder / _name(url)) for url in urls]


def _name(url: str) -> str:
    return unquote(url.rsplit("/", 1)[1])
