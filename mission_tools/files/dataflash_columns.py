"""Records of a DataFlash log as arrays: a tenth of the time of one record after another."""

import re
from array import array
from collections.abc import Container, Mapping
from struct import Struct
from typing import Any, Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from mission_tools.files.dataflash import HEAD_BYTES, Format, Log

Columns = dict[str, NDArray[Any]]
_NOTHING: Final[NDArray[Any]] = np.empty(0)
_FIELD: Final = re.compile(r"(\d*)([a-zA-Z])")


def read_columns(
    data: bytes, wanted: Mapping[str, tuple[str, ...]], texts: Container[str] = ()
) -> tuple[dict[str, Columns], Log]:
    """The wanted fields of each wanted kind of record, each of shape (n,): numbers as float64 in the unit of
    the field; of texts, named by their fields, bytes; NaN where a log has no such field, or a damaged one the
    other of both. They are in the order of the file, unless it defines a kind anew. The log: for its `count`
    and `is_cut`.
    """
    log = Log(data, wanted)
    found: dict[Struct, tuple[Format, array[int]]] = {}
    for at, form in log.places():
        known = found.get(form.layout)
        if known is None:
            known = found[form.layout] = form, array("q")
        known[1].append(at)
    raw, parts = np.frombuffer(data, np.uint8), {name: [_NOTHING] * len(wanted[name]) for name in wanted}
    for form, places in found.values():
        read = _decoded(raw, form, np.frombuffer(places, np.int64))
        held = parts[form.name]
        parts[form.name] = [
            np.concatenate(both) if len(both[0]) else both[1] for both in zip(held, read, strict=True)
        ]
    columns = {name: dict(zip(wanted[name], held, strict=True)) for name, held in parts.items()}
    for kind in columns.values():
        for label, column in kind.items():
            if (column.dtype.kind == "S") is not (label in texts):
                kind[label] = np.full(len(column), np.nan)
    return columns, log


def texts_of(column: NDArray[Any]) -> NDArray[np.str_]:
    """A column of texts; empty ones of a log without the field."""
    raw = column if column.dtype.kind == "S" else np.full(len(column), b"")
    return np.char.decode(raw, "utf-8", "replace")


def parameters_of(records: Columns) -> dict[str, float]:
    """The boat's parameters by name, the last value of each. records: Name, a text, and Value of PARM."""
    return dict(zip(texts_of(records["Name"]).tolist(), records["Value"].tolist(), strict=True))


def _decoded(raw: NDArray[np.uint8], form: Format, at: NDArray[np.int64]) -> list[NDArray[Any]]:
    """The wanted fields of the records of one format."""
    codes = [f"<{'S' + size if size else code}" for size, code in _FIELD.findall(form.layout.format)]
    whole = np.dtype([(str(place), code) for place, code in enumerate(codes)])
    rows = sliding_window_view(raw, form.length)[at][:, HEAD_BYTES:]
    table = np.ascontiguousarray(rows).view(whole)[:, 0]
    out: list[NDArray[Any]] = []
    for field in form.wanted:
        column = np.full(len(at), np.nan) if field is None else table[str(field.place)]
        with np.errstate(invalid="ignore"):  # a signalling NaN in a damaged log
            out.append(column.astype(np.float64) * field.factor if field and field.factor else column)
    return out
