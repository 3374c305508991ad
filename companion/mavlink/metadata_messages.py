"""Messages and fields of MAVLink's common set that the generated dialect lacks. Imported, they join it."""

import struct
from typing import Any, ClassVar

from pymavlink.dialects.v20 import all as generated

_CODES = {"uint8_t": "B", "uint16_t": "H", "uint32_t": "I", "char": "100s"}  # the texts are uris


class _Message(generated.MAVLink_message):  # type: ignore[misc]
    """Takes its fields by name or in the order of the definition; omitted ones are 0."""

    id: ClassVar[int]
    fieldnames: ClassVar[tuple[str, ...]]

    def __init__(self, *values: Any, **named: Any) -> None:  # noqa: ANN401
        super().__init__(self.id, self.msgname)
        self._fieldnames = self.fieldnames
        fields = dict(zip(self.fieldnames, values, strict=False)) | named
        if unknown := fields.keys() - set(self.fieldnames):
            raise TypeError(f"{self.msgname} has no {', '.join(sorted(unknown))}")
        for name, kind in zip(self.fieldnames, self.fieldtypes, strict=True):
            value = fields.get(name, 0)
            if kind == "char":
                setattr(self, f"_{name}_raw", value)
                value = value.split(b"\x00", 1)[0].decode("ascii", errors="replace")
            setattr(self, name, value)

    def pack(self, mav: Any, force_mavlink1: bool = False) -> bytes:  # noqa: ANN401
        types = dict(zip(self.fieldnames, self.fieldtypes, strict=True))
        names = (f"_{name}_raw" if types[name] == "char" else name for name in self.ordered_fieldnames)
        payload = self.unpacker.pack(*(getattr(self, name) for name in names))
        frame: bytes = self._pack(mav, self.crc_extra, payload, force_mavlink1=force_mavlink1)
        return frame


def _define(number: int, name: str, crc_extra: int, extensions: int, **fields: str) -> type[_Message]:
    """A message class. fields: their types, in the definition's order; the last ones are extensions."""
    names = tuple(fields)
    base = names[: len(names) - extensions]
    size = {name: 1 if kind == "char" else struct.calcsize(_CODES[kind]) for name, kind in fields.items()}
    ordered = (*sorted(base, key=lambda one: -size[one]), *names[len(base) :])
    codes = "<" + "".join(_CODES[fields[one]] for one in ordered)
    members = {
        "id": number,
        "msgname": name,
        "fieldnames": names,
        "ordered_fieldnames": ordered,
        "fieldtypes": tuple(fields.values()),
        "native_format": codes.replace("100s", "c").encode("ascii"),
        "orders": tuple(ordered.index(one) for one in names),
        "lengths": (1,) * len(names),
        "array_lengths": tuple(100 if fields[one] == "char" else 0 for one in ordered),
        "crc_extra": crc_extra,
        "unpacker": struct.Struct(codes),
    }
    return type(f"MAVLink_{name.lower()}_message", (_Message,), members)


def _add(message_type: type[_Message]) -> None:
    setattr(generated, message_type.__name__, message_type)
    setattr(generated, f"MAVLINK_MSG_ID_{message_type.msgname}", message_type.id)
    generated.mavlink_map[message_type.id] = message_type


ComponentMetadata = _define(
    397, "COMPONENT_METADATA", 182, 0, time_boot_ms="uint32_t", file_crc="uint32_t", uri="char"
)
# The older form, with a second file for peripherals
ComponentInformation = _define(
    395,
    "COMPONENT_INFORMATION",
    0,
    0,
    time_boot_ms="uint32_t",
    general_metadata_file_crc="uint32_t",
    general_metadata_uri="char",
    peripherals_metadata_file_crc="uint32_t",
    peripherals_metadata_uri="char",
)
# With the identities of the three lists, by which stations notice an upload by another. They are extensions,
# which readers of an older definition cut off. 0: no such list.
MissionCurrent = _define(
    42,
    "MISSION_CURRENT",
    28,
    6,
    seq="uint16_t",
    total="uint16_t",
    mission_state="uint8_t",
    mission_mode="uint8_t",
    mission_id="uint32_t",
    fence_id="uint32_t",
    rally_points_id="uint32_t",
)

for _message_type in (ComponentMetadata, ComponentInformation):
    if _message_type.id not in generated.mavlink_map:
        _add(_message_type)
if "mission_id" not in generated.MAVLink_mission_current_message.fieldnames:
    _add(MissionCurrent)
