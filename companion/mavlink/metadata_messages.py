"""Messages and fields of MAVLink's common set that the generated dialect lacks."""

import struct
from typing import Any

from pymavlink.dialects.v20 import all as generated

Base: Any = generated.MAVLink_message


class _Message(Base):  # type: ignore[misc]
    def pack(self, mav: Any, force_mavlink1: bool = False) -> bytes:  # noqa: ANN401
        types = dict(zip(self.fieldnames, self.fieldtypes, strict=True))
        names = (f"_{name}_raw" if types[name] == "char" else name for name in self.ordered_fieldnames)
        payload = self.unpacker.pack(*(getattr(self, name) for name in names))
        frame: bytes = self._pack(mav, self.crc_extra, payload, force_mavlink1=force_mavlink1)
        return frame


class ComponentMetadata(_Message):
    """COMPONENT_METADATA: uri of the component's general metadata file, and its CRC-32."""

    id = 397
    msgname = "COMPONENT_METADATA"
    fieldnames = ordered_fieldnames = ("time_boot_ms", "file_crc", "uri")
    fieldtypes = ("uint32_t", "uint32_t", "char")
    native_format = b"<IIc"
    orders = (0, 1, 2)
    lengths = (1, 1, 1)
    array_lengths = (0, 0, 100)
    crc_extra = 182
    unpacker = struct.Struct("<II100s")

    def __init__(self, time_boot_ms: int, file_crc: int, uri: bytes) -> None:
        super().__init__(self.id, self.msgname)
        self._fieldnames = self.fieldnames
        self.time_boot_ms = time_boot_ms
        self.file_crc = file_crc
        self._uri_raw = uri
        self.uri = _text(uri)


class ComponentInformation(_Message):
    """COMPONENT_INFORMATION: the older form, with a second file for peripherals."""

    id = 395
    msgname = "COMPONENT_INFORMATION"
    fieldnames = (
        "time_boot_ms",
        "general_metadata_file_crc",
        "general_metadata_uri",
        "peripherals_metadata_file_crc",
        "peripherals_metadata_uri",
    )
    ordered_fieldnames = (
        "time_boot_ms",
        "general_metadata_file_crc",
        "peripherals_metadata_file_crc",
        "general_metadata_uri",
        "peripherals_metadata_uri",
    )
    fieldtypes = ("uint32_t", "uint32_t", "char", "uint32_t", "char")
    native_format = b"<IIIcc"
    orders = (0, 1, 3, 2, 4)
    lengths = (1, 1, 1, 1, 1)
    array_lengths = (0, 0, 0, 100, 100)
    crc_extra = 0
    unpacker = struct.Struct("<III100s100s")

    def __init__(
        self,
        time_boot_ms: int,
        general_metadata_file_crc: int,
        general_metadata_uri: bytes,
        peripherals_metadata_file_crc: int,
        peripherals_metadata_uri: bytes,
    ) -> None:
        super().__init__(self.id, self.msgname)
        self._fieldnames = self.fieldnames
        self.time_boot_ms = time_boot_ms
        self.general_metadata_file_crc = general_metadata_file_crc
        self._general_metadata_uri_raw = general_metadata_uri
        self.general_metadata_uri = _text(general_metadata_uri)
        self.peripherals_metadata_file_crc = peripherals_metadata_file_crc
        self._peripherals_metadata_uri_raw = peripherals_metadata_uri
        self.peripherals_metadata_uri = _text(peripherals_metadata_uri)


class MissionCurrent(_Message):
    """MISSION_CURRENT with the identities of the three lists, by which stations notice an upload by another.

    They are extensions, which readers of an older definition cut off. 0: no such list.
    """

    id = 42
    msgname = "MISSION_CURRENT"
    fieldnames = ordered_fieldnames = (
        "seq",
        "total",
        "mission_state",
        "mission_mode",
        "mission_id",
        "fence_id",
        "rally_points_id",
    )
    fieldtypes = ("uint16_t", "uint16_t", "uint8_t", "uint8_t", "uint32_t", "uint32_t", "uint32_t")
    native_format = b"<HHBBIII"
    orders = (0, 1, 2, 3, 4, 5, 6)
    lengths = (1, 1, 1, 1, 1, 1, 1)
    array_lengths = (0, 0, 0, 0, 0, 0, 0)
    crc_extra = 28
    unpacker = struct.Struct("<HHBBIII")

    def __init__(
        self,
        seq: int,
        total: int = 0,
        mission_state: int = 0,
        mission_mode: int = 0,
        mission_id: int = 0,
        fence_id: int = 0,
        rally_points_id: int = 0,
    ) -> None:
        super().__init__(self.id, self.msgname)
        self._fieldnames = self.fieldnames
        self.seq = seq
        self.total = total
        self.mission_state = mission_state
        self.mission_mode = mission_mode
        self.mission_id = mission_id
        self.fence_id = fence_id
        self.rally_points_id = rally_points_id


def _text(raw: bytes) -> str:
    return raw.split(b"\x00", 1)[0].decode("ascii", errors="replace")


for _message_type in (ComponentMetadata, ComponentInformation):
    generated.mavlink_map.setdefault(_message_type.id, _message_type)
if "mission_id" not in generated.MAVLink_mission_current_message.fieldnames:
    generated.mavlink_map[MissionCurrent.id] = generated.MAVLink_mission_current_message = MissionCurrent
