"""The parameters as the page gets them: one JSON document."""

from typing import Any, Final

import msgspec

from companion.core.units import as_float32
from mission_tools.station.parameters.metadata import Description
from mission_tools.station.parameters.parameter_table import TableSnapshot
from mission_tools.station.parameters.values import Value

_LOADING: Final = ("waiting", "asking", "reading")


def document(snapshot: TableSnapshot, values: list[tuple[str, Value]]) -> bytes:
    """{missing, texts, parameters: […]} by name. values: of the snapshot, copied.

    texts: loading, here or none. Takes milliseconds: use a thread.
    """
    texts = "loading" if snapshot.texts in _LOADING or snapshot.packed is not None else snapshot.texts
    rows = [_row(name, value, snapshot.descriptions.of(name)) for name, value in sorted(values)]
    return msgspec.json.encode({"missing": snapshot.missing, "texts": texts, "parameters": rows})


def _row(name: str, value: Value, known: Description) -> dict[str, Any]:
    is_changed = (
        known.default is not None
        and value.value is not None
        and as_float32(value.value) != as_float32(known.default)
    )
    return {
        "name": name,
        "value": value.number(),
        "type": value.type,
        "text": known.text,
        "long": known.long,
        "unit": known.unit,
        "min": known.low,
        "max": known.high,
        "step": known.step,
        "decimals": known.decimals,
        "values": [{"value": number, "text": text} for number, text in known.values],
        "bits": [{"bit": bit, "text": text} for bit, text in known.bits],
        "default": known.default,
        "changed": is_changed,
        "group": known.group or name.partition("_")[0].rstrip("0123456789") or name,
        "reboot_required": known.needs_restart,
        "read_only": known.read_only,
    }
