"""The boat's description of itself: JSON files that a station fetches by file transfer.

After the MAVLink guide, "Component Metadata Protocol", and its schemas: a general file, which leads to one
about the parameters. Both are made from the one table of parameters and are the same from boot to boot, so a
station that knows their checksums need not fetch them again. Other subjects (events, actuators) are absent.
"""

import json
import math
from functools import cache
from typing import Any

from companion import __version__
from companion.config import BoatConfig
from companion.mavlink.dialect import Message
from companion.mavlink.metadata_messages import ComponentInformation, ComponentMetadata
from companion.params import Kind, Parameters, Row
from companion.params_table import ROWS
from companion.services.ftp_tree import checksum
from companion.services.ftp_virtual import Content
from companion.services.snapshot import Snapshot
from companion.storage import MemoryStorage

COMPONENT_INFORMATION_ID: int = ComponentInformation.id
COMPONENT_METADATA_ID: int = ComponentMetadata.id
_PARAMETER_METADATA = 1  # COMP_METADATA_TYPE_PARAMETER, which the dialect lacks
FOLDER = "metadata"
GENERAL, PARAMETERS = "general.json", "parameters.json"
_TYPES = {Kind.INT8: "Int8", Kind.INT16: "Int16", Kind.INT32: "Int32", Kind.REAL32: "Float"}


def uri_of(name: str) -> str:
    """Where a station finds a file."""
    return f"mftp:///{FOLDER}/{name}"


@cache
def general_json() -> bytes:
    """The general file."""
    metadata = {
        "type": _PARAMETER_METADATA,
        "uri": uri_of(PARAMETERS),
        "fileCrc": _crc(parameters_json()),
    }
    tree = {
        "version": 1,
        "vendorName": "mavboat",
        "modelName": "mavboat companion",
        "firmwareVersion": __version__,
        "metadataTypes": [metadata],
    }
    return _encode(tree)


@cache
def parameters_json() -> bytes:
    """The file about the parameters."""
    parameters = Parameters(BoatConfig(), ROWS, MemoryStorage())
    entries = [_entry(row, parameters.value(row)) for row in ROWS]
    return _encode({"version": 2, "parameters": entries})


def component_metadata(now: Snapshot) -> Message:
    """COMPONENT_METADATA."""
    return ComponentMetadata(now.boot_ms, _crc(general_json()), uri_of(GENERAL).encode("ascii"))


def component_information(now: Snapshot) -> Message:
    """COMPONENT_INFORMATION, the older form; there are no peripherals."""
    return ComponentInformation(
        time_boot_ms=now.boot_ms,
        general_metadata_file_crc=_crc(general_json()),
        general_metadata_uri=uri_of(GENERAL).encode("ascii"),
        peripherals_metadata_file_crc=0,
        peripherals_metadata_uri=b"",
    )


def _entry(row: Row, default: float) -> dict[str, Any]:
    """A parameter after the schema, which has no word for read-only: such a one has no other value."""
    low, high = (default, default) if row.read_only else (row.low, row.high)
    entry: dict[str, Any] = {
        "name": row.name,
        "type": _TYPES[row.kind],
        "shortDesc": row.text,
        "default": _number(row, default),
        "group": row.name.partition("_")[0].rstrip("0123456789"),
        "category": "Constant" if row.read_only else "Standard",
    }
    if row.unit:
        entry["units"] = row.unit
    if math.isfinite(low):
        entry["min"] = _number(row, low)
    if math.isfinite(high):
        entry["max"] = _number(row, high)
    return entry


def _number(row: Row, value: float) -> float:
    """As short as it is exact: the wire's 0.1 is not 0.10000000149."""
    if row.kind is not Kind.REAL32:
        return round(value)
    return float(f"{value:.7g}")


def _encode(tree: dict[str, Any]) -> bytes:
    return json.dumps(tree, allow_nan=False, separators=(",", ":"), ensure_ascii=True).encode("ascii")


@cache
def _crc(content: bytes) -> int:
    return checksum(Content(content))
