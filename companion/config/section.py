"""Base of all TOML tables: strict keys, finite numbers, common ranges."""

from collections.abc import Sequence
from typing import Annotated, TypeVar

import msgspec
from msgspec import Meta

Share = Annotated[float, Meta(ge=0.0, le=1.0)]
NonNegative = Annotated[float, Meta(ge=0.0)]
Positive = Annotated[float, Meta(gt=0.0)]
SystemId = Annotated[int, Meta(ge=1, le=255)]


FLOAT32_MAX = 3.4028234663852886e38  # limit of a MAVLink parameter


class Section(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A table of the TOML file. A ValueError names the field with a number that is not finite."""

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            value = getattr(self, name)
            if isinstance(value, float) and not abs(value) <= FLOAT32_MAX:
                raise ValueError(f"{name} = {value}: expected a finite number")


S = TypeVar("S", bound=Section)


def replaced(table: S, path: Sequence[str], value: object) -> S:
    """A copy of a table with one value changed. path: names of the nested tables, then the key.

    LookupError: no such key, or it names a table; ValidationError: a value outside the key's type or range.
    """
    name, *rest = path
    if name not in table.__struct_fields__:
        raise LookupError(name)
    current = getattr(table, name)
    if isinstance(current, Section) is not bool(rest):
        raise LookupError(name)
    if rest:
        return msgspec.structs.replace(table, **{name: replaced(current, rest, value)})
    fields = {field: getattr(table, field) for field in table.__struct_fields__}
    return msgspec.convert({**fields, name: value}, type(table), strict=True)
