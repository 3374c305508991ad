"""What the boat says of itself, held to the schemas of the MAVLink project, which are written out here."""

import json
import re
import struct
import zlib

import pytest
from boat_rig import OK, Rig
from ftp_client import Served
from qgc_metadata import unpacked

from companion.config.parameter_table import ROWS
from companion.mavlink.ftp_frames import Opcode
from companion.services.ftp.component_metadata import metadata_files, parameters_json

TYPES = {"Uint8", "Int8", "Uint16", "Int16", "Uint32", "Int32", "Float"}
KEYS = {
    "name", "type", "shortDesc", "longDesc", "units", "default", "decimalPlaces", "min", "max", "increment",
    "rebootRequired", "group", "category", "volatile", "values", "bitmask", "readOnly",
}  # fmt: skip
REQUEST_MESSAGE = 512
PARAMETERS = b"/metadata/parameters.json.xz"


def general(served: Served) -> dict[str, object]:
    tree: dict[str, object] = json.loads(served.get(b"/metadata/general.json"))
    return tree


def test_the_general_file_leads_to_the_parameters_with_their_checksum() -> None:
    served = Served()
    tree = general(served)
    assert set(tree) <= {"version", "vendorName", "modelName", "firmwareVersion", "metadataTypes"}
    assert tree["version"] == 1
    assert re.fullmatch(r"\d+\.\d+\.\d+(\.\d+)?", str(tree["firmwareVersion"]))
    assert tree["metadataTypes"] == [
        {
            "type": 1,
            "uri": "mftp:///metadata/parameters.json.xz",
            "fileCrc": crc(served, "parameters.json.xz"),
        }
    ]


def crc(served: Served, name: str) -> int:
    data = served.ask(Opcode.CALC_FILE_CRC32, f"/metadata/{name}".encode()).data
    return int(struct.unpack("<I", data)[0])


def mavlink_crc(content: bytes) -> int:
    return zlib.crc32(content, 0xFFFFFFFF) ^ 0xFFFFFFFF


def test_the_parameters_are_packed_as_qgroundcontrol_unpacks_them_and_always_alike() -> None:
    packed = Served().get(PARAMETERS)
    plain = unpacked("parameters.json.xz", packed)
    assert plain == parameters_json(ROWS)
    assert 8 * len(packed) < len(plain)
    metadata_files.cache_clear()
    assert metadata_files(ROWS).parameters == packed


def test_every_parameter_is_described_as_the_schema_allows() -> None:
    tree = json.loads(unpacked("parameters.json.xz", Served().get(PARAMETERS)))
    assert set(tree) == {"version", "parameters"}
    assert [entry["name"] for entry in tree["parameters"]] == [row.name for row in ROWS]
    for entry, row in zip(tree["parameters"], ROWS, strict=True):
        assert set(entry) <= KEYS
        assert entry["type"] in TYPES
        assert re.fullmatch(r"[.\-a-zA-Z0-9_{}]{1,16}", entry["name"])
        assert entry["shortDesc"] == row.text
        assert entry.get("units", "") == ("C" if row.unit == "degC" else row.unit)
        assert entry["min"] <= entry["default"] <= entry["max"], entry
        assert isinstance(entry.get("decimalPlaces", 0), int)
        assert 0 <= entry.get("decimalPlaces", 0) <= 7
        assert all(set(one) == {"value", "description"} for one in entry.get("values", ()))
        assert all(set(one) == {"index", "description"} for one in entry.get("bitmask", ()))
        assert all(isinstance(one["index"], int) for one in entry.get("bitmask", ()))
        if row.read_only:
            assert entry["category"] == "Constant"
            assert entry["readOnly"]


def test_numbers_are_as_people_write_them() -> None:
    tree = json.loads(unpacked("parameters.json.xz", Served().get(PARAMETERS)))
    entries = {entry["name"]: entry for entry in tree["parameters"]}
    assert entries["HND_SLIP"]["default"] == 0.4
    assert entries["SYSID_THISMAV"]["default"] == 1
    assert entries["HDG_KI"]["group"] == "HDG"
    assert entries["RC1_MIN"]["group"] == "RC"


@pytest.mark.parametrize("number", [395, 397])
def test_a_station_that_asks_is_led_to_the_general_file(number: int) -> None:
    rig = Rig()
    rig.step()
    assert rig.ask(REQUEST_MESSAGE, number) == OK
    if number == 397:
        (answer,) = rig.peer.said("COMPONENT_METADATA")
        uri, checksum = answer.uri, answer.file_crc
    else:
        (answer,) = rig.peer.said("COMPONENT_INFORMATION")
        uri, checksum = answer.general_metadata_uri, answer.general_metadata_file_crc
        assert (answer.peripherals_metadata_uri.strip("\0"), answer.peripherals_metadata_file_crc) == ("", 0)
    assert uri.rstrip("\0") == "mftp:///metadata/general.json"
    assert checksum == mavlink_crc(metadata_files(rig.boat.parameters.rows).general)
