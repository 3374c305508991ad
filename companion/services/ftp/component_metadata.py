"""Component metadata: JSON files that stations fetch by file transfer.

After the MAVLink guide, "Component Metadata Protocol", and its schemas: a general file refers to the
packed parameter file. Both are generated from the boat's parameters when it starts and are constant, so a
station that knows their checksums need not fetch them again. Other subjects (events, actuators) are not
provided.
"""

import json
import lzma
import math
from decimal import Decimal
from functools import cache
from typing import Any, NamedTuple

from companion import __version__
from companion.autopilot.snapshot import Snapshot
from companion.config.boat_config import BoatConfig
from companion.config.parameters import ParameterRow, Parameters, ParameterType
from companion.core.storage import MemoryStorage
from companion.core.units import shortest
from companion.mavlink.dialect import Message, build_message
from companion.services.ftp.tree import checksum
from companion.services.ftp.virtual import Content

_PARAMETER_METADATA = 1  # COMP_METADATA_TYPE_PARAMETER, which the dialect lacks
FOLDER = "metadata"
GENERAL, PARAMETERS = "general.json", "parameters.json.xz"
# A tenth of the plain file's bytes. The dictionary holds the whole file; with the default one xz takes 94 MB.
_PACKING = [{"id": lzma.FILTER_LZMA2, "preset": 6, "dict_size": 1 << 16}]
# The only version that QGroundControl reads (4.4 to 5.0). The schema is at 3 now, without a change to the
# fields used here.
_READ_BY_QGC = 1
_UNITS = {"degC": "C"}  # the schema's name of a unit that stations convert
_MOST_DECIMALS = 7  # the schema's default
_TYPES = {
    ParameterType.INT8: "Int8",
    ParameterType.INT16: "Int16",
    ParameterType.INT32: "Int32",
    ParameterType.REAL32: "Float",
}


def uri_of(name: str) -> str:
    return f"mftp:///{FOLDER}/{name}"


class MetadataFiles(NamedTuple):
    """Their content. parameters: packed by xz."""

    general: bytes
    parameters: bytes


@cache
def metadata_files(rows: tuple[ParameterRow, ...]) -> MetadataFiles:
    """The files of a boat with these parameters; made once, in about 10 ms of a desk computer."""
    # The checksum is one that all readers of xz know
    packed = lzma.compress(parameters_json(rows), lzma.FORMAT_XZ, check=lzma.CHECK_CRC32, filters=_PACKING)
    metadata = {"type": _PARAMETER_METADATA, "uri": uri_of(PARAMETERS), "fileCrc": _crc(packed)}
    tree = {
        "version": 1,
        "vendorName": "mavboat",
        "modelName": "mavboat companion",
        "firmwareVersion": __version__,
        "metadataTypes": [metadata],
    }
    return MetadataFiles(_encode(tree), packed)


def parameters_json(rows: tuple[ParameterRow, ...]) -> bytes:
    """The parameter file, unpacked."""
    parameters = Parameters(BoatConfig(), rows, MemoryStorage())
    entries = [_entry(row, parameters.value(row)) for row in rows]
    return _encode({"version": _READ_BY_QGC, "parameters": entries})


def component_metadata(now: Snapshot) -> Message:
    crc, uri = _general_crc(now), uri_of(GENERAL).encode("ascii")
    return build_message("COMPONENT_METADATA", time_boot_ms=now.boot_ms, file_crc=crc, uri=uri)


def component_information(now: Snapshot) -> Message:
    """COMPONENT_INFORMATION, the older form; there are no peripherals."""
    return build_message(
        "COMPONENT_INFORMATION",
        time_boot_ms=now.boot_ms,
        general_metadata_file_crc=_general_crc(now),
        general_metadata_uri=uri_of(GENERAL).encode("ascii"),
    )


def _entry(row: ParameterRow, default: float) -> dict[str, Any]:
    """A parameter by the schema and QGroundControl's stricter reader.

    Some versions need `decimalPlaces` to show fractions, and `values` to fill the menu of a choice.
    """
    low, high = _range(row, default)
    entry: dict[str, Any] = {
        "name": row.name,
        "type": _TYPES[row.kind],
        "shortDesc": row.text,
        "default": _number(row, default),
        "group": row.name.partition("_")[0].rstrip("0123456789"),
        "category": "Constant" if row.read_only else "Standard",
    }
    optional = {
        "decimalPlaces": _decimals(row, default) if row.kind is ParameterType.REAL32 else None,
        "rebootRequired": row.needs_restart or None,
        "readOnly": row.read_only or None,
        "units": _UNITS.get(row.unit, row.unit) or None,
        "min": _number(row, low) if math.isfinite(low) else None,
        "max": _number(row, high) if math.isfinite(high) else None,
        "values": [{"value": number, "description": name} for number, name in row.values] or None,
        "bitmask": [{"index": number, "description": name} for number, name in row.bits] or None,
    }
    return entry | {key: value for key, value in optional.items() if value is not None}


def _range(row: ParameterRow, default: float) -> tuple[float, float]:
    """The allowed range; of a constant, its value."""
    if row.values:
        numbers = [float(number) for number, _ in row.values]
        return min(numbers), max(numbers)
    return (default, default) if row.read_only else (row.low, row.high)


def _number(row: ParameterRow, value: float) -> float:
    """The shortest number with the same 32-bit float, so that unchanged values are recognised."""
    return float(shortest(value)) if row.kind is ParameterType.REAL32 else round(value)


def _decimals(row: ParameterRow, default: float) -> int:
    """Decimal places of the row, or of its default and bounds if more."""
    numbers = [number for number in (default, row.low, row.high) if math.isfinite(number)]
    places = [-int(Decimal(shortest(number)).normalize().as_tuple().exponent) for number in numbers]
    return min(max(row.decimals, *places), _MOST_DECIMALS)


def _encode(tree: dict[str, Any]) -> bytes:
    return json.dumps(tree, allow_nan=False, separators=(",", ":"), ensure_ascii=True).encode("ascii")


def _general_crc(now: Snapshot) -> int:
    return _crc(metadata_files(now.rows).general)


def _crc(content: bytes) -> int:
    return checksum(Content(content))
