"""Wheels made by hand, right and wrong."""

import base64
import hashlib
import zipfile
from collections.abc import Mapping
from pathlib import Path

METADATA = "Metadata-Version: 2.4\nName: mavboat\nVersion: {version}\nRequires-Python: >=3.11\n{more}\n"
WHEEL = "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
PROGRAMS = "[console_scripts]\nboat-companion = companion.__main__:main\n"


def record_line(name: str, content: bytes) -> str:
    """A line of RECORD."""
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def contents(
    version: str = "0.2.0", files: Mapping[str, bytes | None] | None = None, requires: str = ""
) -> dict[str, bytes]:
    """The members of a wheel without its RECORD. files: more or other ones; None: that one is missing."""
    info = f"mavboat-{version}.dist-info"
    every: dict[str, bytes | None] = {
        "companion/__init__.py": b'"""A boat."""\n',
        f"{info}/METADATA": METADATA.format(version=version, more=requires).encode(),
        f"{info}/WHEEL": WHEEL.encode(),
        f"{info}/entry_points.txt": PROGRAMS.encode(),
        **(files or {}),
    }
    return {name: content for name, content in every.items() if content is not None}


def make_wheel(
    folder: Path,
    version: str = "0.2.0",
    files: Mapping[str, bytes | None] | None = None,
    requires: str = "",
    record: str | None = None,
) -> Path:
    """A wheel in this folder. record: its text in the place of the right one."""
    path = folder / f"mavboat-{version}-py3-none-any.whl"
    members = contents(version, files, requires)
    name = f"mavboat-{version}.dist-info/RECORD"
    text = "".join(record_line(*one) for one in members.items()) + f"{name},,\n"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for one, content in members.items():
            archive.writestr(one, content)
        archive.writestr(name, text if record is None else record)
    return path
