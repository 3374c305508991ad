"""The log's format, read back by pymavlink, which none of our code wrote."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from log_rig import of_kind, read_log

from companion.log.records import FMT, HEADER, KINDS, MSG, MULT, RecordKind

_WHOLE = {
    "b": 8, "B": 8, "h": 16, "H": 16, "i": 32, "I": 32, "Q": 64, "c": 16, "C": 16, "e": 32, "L": 32, "M": 7
}  # fmt: skip
_SIGNED = "bhice L"


def values_of(kind: RecordKind) -> st.SearchStrategy[tuple[Any, ...]]:
    """Any raw values that the kind's fields hold."""

    def of(code: str) -> st.SearchStrategy[Any]:
        if code in "fd":
            return st.floats(width=32, allow_nan=False)
        if code in "nNZ":
            most = {"n": 4, "N": 16, "Z": 64}[code]
            return st.text(st.characters(codec="ascii", exclude_characters="\0"), max_size=most).map(
                str.encode
            )
        bits = _WHOLE[code]
        low, high = (-(2 ** (bits - 1)), 2 ** (bits - 1)) if code in _SIGNED else (0, 2**bits)
        return st.integers(low, high - 1)

    return st.tuples(*(of(code) for code in kind.codes))


@settings(max_examples=30)
@given(st.data())
def test_any_record_reads_back_as_it_was_written(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    kind = data.draw(st.sampled_from([kind for kind in KINDS if kind.codes[0] == "Q"]))
    values = data.draw(values_of(kind))
    path = tmp_path_factory.mktemp("log") / "1.bin"
    path.write_bytes(HEADER + kind.pack(*values))
    (record,) = of_kind(read_log(path), kind.name)
    raw = [value.rstrip(b"\0") if isinstance(value, bytes) else value for value in record._elements]
    assert raw == list(values)
    assert record.get_fieldnames() == kind.columns.split(",")


def test_every_kind_is_defined_with_its_units(tmp_path: Path) -> None:
    path = tmp_path / "1.bin"
    path.write_bytes(HEADER)
    records = read_log(path)
    assert {record.Name for record in of_kind(records, "FMT")} >= {kind.name for kind in KINDS}
    assert len({kind.number for kind in KINDS} | {FMT.number}) == len(KINDS) + 1
    assert all((kind.codes[0], kind.units[0], kind.multipliers[0]) == ("Q", "s", "F") for kind in KINDS)
    lengths = {record.Name: record.Length for record in of_kind(records, "FMT")}
    assert all(lengths[kind.name] == len(kind.pack(*_zeros(kind))) for kind in KINDS)
    units = {record.FmtType: record.UnitIds for record in of_kind(records, "FMTU")}
    assert all(units[kind.number] == kind.units for kind in KINDS)
    multipliers = {chr(record.Id): record.Mult for record in of_kind(records, MULT.name)}
    assert [multipliers[one] for one in "ABCFG"] == pytest.approx([0.1, 0.01, 1e-3, 1e-6, 1e-7])


def _zeros(kind: RecordKind) -> list[object]:
    return [b"" if code in "nNZ" else 0 for code in kind.codes]


@settings(max_examples=25)
@given(cut=st.integers(0, 10 * MSG.size_bytes - 1))
def test_what_stands_before_a_torn_end_can_be_read(
    tmp_path_factory: pytest.TempPathFactory, cut: int
) -> None:
    path = tmp_path_factory.mktemp("log") / "1.bin"
    path.write_bytes(HEADER + b"".join(MSG.pack(n, b"line %d" % n) for n in range(10))[:cut])
    whole = cut // MSG.size_bytes
    assert [record.TimeUS for record in of_kind(read_log(path), "MSG")] == list(range(whole))


@pytest.mark.parametrize(
    ("codes", "columns", "units", "multipliers"),
    [
        ("Qf", "TimeUS", "s", "F"),
        ("Q", "TimeUS,A", "s-", "F-"),
        ("Q", "TimeUS", "", "F"),
        ("Q", "TimeUS", "s", ""),
        ("Q", "TimeUS", "~", "F"),
        ("Q", "TimeUS", "s", "~"),
        (17 * "B", ",".join(17 * "A"), 17 * "-", 17 * "-"),
        ("QB", "TimeUS," + 60 * "A", "s-", "F-"),
    ],
)
def test_a_kind_that_does_not_fit_together_is_refused(
    codes: str, columns: str, units: str, multipliers: str
) -> None:
    with pytest.raises(ValueError, match="log record ODD"):
        RecordKind(7, "ODD", codes, columns, units, multipliers)
    for number, is_fine in ((0, False), (1, True), (255, True), (256, False)):
        with nullcontext() if is_fine else pytest.raises(ValueError, match="log record SOME"):
            RecordKind(number, "SOME", "Q", "TimeUS", "s", "F")
