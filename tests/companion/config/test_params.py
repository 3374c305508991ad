import math
import struct
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import mavparm

from companion.config.boat_config import BoatConfig
from companion.config.parameter_page import parameter_page
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters, ParameterType
from companion.core.storage import FolderStorage, MemoryStorage

FILE = "params.parm"
LIVE = [row for row in ROWS if row.path]
BY_NAME = {row.name: row for row in ROWS}


def fresh(storage: MemoryStorage | None = None) -> Parameters:
    return Parameters(BoatConfig(), ROWS, storage or MemoryStorage())


def float32(value: float) -> float:
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


def test_the_default_of_a_row_lies_in_its_range_and_can_be_written_back() -> None:
    parameters = fresh()
    for row in ROWS:
        default = parameters.value(row)
        assert row.low <= default <= row.high, row
        assert row.kind is ParameterType.REAL32 or default == int(default), row
        assert parameters.set(row.name, default) == ""
        assert parameters.value(row) == default, row
        assert row.text


def test_both_ends_of_a_range_fit_the_field_behind_it_and_nothing_beyond_is_accepted() -> None:
    for row in LIVE:
        for value in (row.low, row.high):
            parameters = fresh()
            assert parameters.set(row.name, value) == ""
            assert parameters.value(row) == pytest.approx(value, rel=1e-6), row
        before = parameters.config
        for value in (row.low - 1.0, row.high * 1.01 + 1.0, math.nan, math.inf, -math.inf, 3e38):
            assert row.name in parameters.set(row.name, value)
        assert parameters.config is before, row


def test_a_channels_option_makes_it_the_one_that_arms() -> None:
    parameters = fresh()
    assert parameters.set("RC7_OPTION", 153.0) == ""
    assert parameters.config.rc.arm_channel == 7
    assert parameters.set("RC9_OPTION", 153.0) == ""
    options = {number: parameters.value(BY_NAME[f"RC{number}_OPTION"]) for number in range(5, 17)}
    assert [number for number, value in options.items() if value] == [9]
    assert parameters.set("RC7_OPTION", 0.0) == ""  # which it is already
    assert parameters.config.rc.arm_channel == 9
    assert parameters.set("RC9_OPTION", 0.0) == ""
    assert parameters.config.rc.arm_channel == 0


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("RC7_OPTION", 4.0, "RC7_OPTION: 4 is not one of 0, 153"),
        ("MODE1", 2.0, "MODE1: 2 is not one of 0, 1, 3"),
        ("AHRS_ORIENTATION", 4.0, "AHRS_ORIENTATION is fixed at 0"),
        ("FS_CRASH_CHECK", 1.0, "FS_CRASH_CHECK is fixed at 0"),
    ],
)
def test_a_choice_that_the_boat_does_not_have_is_refused(name: str, value: float, words: str) -> None:
    parameters = fresh()
    assert words in parameters.set(name, value)
    assert parameters.value(BY_NAME[name]) == 0.0


def test_changes_survive_a_restart_and_only_they_are_written() -> None:
    storage = MemoryStorage()
    parameters = fresh(storage)
    parameters.set("HDG_KP", float32(3.3))
    parameters.set("SYSID_MYGCS", 250.0)
    assert storage.content[FILE].decode().splitlines() == ["HDG_KP 3.3", "SYSID_MYGCS 250"]
    again = fresh(storage)
    assert again.config == parameters.config
    assert again.config.heading.kp == 3.3


def test_lines_that_cannot_be_used_are_skipped_and_the_others_count(caplog: pytest.LogCaptureFixture) -> None:
    storage = MemoryStorage()
    storage.content[FILE] = (
        b"# mine\nHDG_KP,4\nHDG_KI\nNOPE 1\nHDG_KD x\n\xff\xfe\nRTL_SPEED 1e9\nLOIT_RADIUS\t3\n"
    )
    parameters = fresh(storage)
    assert parameters.config.heading.kp == 4.0
    assert parameters.config.guidance.station_radius_m == 3.0
    assert parameters.config.mission.rtl_speed_m_s == 0.0
    assert [record.args[1] for record in caplog.records if isinstance(record.args, tuple)] == [3, 4, 5, 6, 7]


@given(st.binary(max_size=200))
def test_any_file_at_all_leaves_a_boat_that_can_be_configured(content: bytes) -> None:
    storage = MemoryStorage()
    storage.content[FILE] = content
    assert fresh(storage).set("HDG_KP", 1.0) == ""


def test_a_ground_stations_own_reader_reads_the_file(tmp_path: Path) -> None:
    storage = FolderStorage(tmp_path)
    parameters = Parameters(BoatConfig(), ROWS, storage)
    parameters.set("HDG_KP", float32(3.3))
    parameters.set("LOIT_RADIUS", 2.0)
    storage.close()
    read = mavparm.MAVParmDict()
    assert read.load(str(tmp_path / FILE))
    assert dict(read) == {"HDG_KP": 3.3, "LOIT_RADIUS": 2.0}


def test_a_change_that_cannot_be_kept_is_told_once(tmp_path: Path) -> None:
    def refuse(path: Path, content: bytes, keep: Path | None) -> None:
        raise OSError(28, "No space left on device")

    storage = FolderStorage(tmp_path, refuse)
    parameters = Parameters(BoatConfig(), ROWS, storage)
    assert parameters.poll_saves() == []
    parameters.set("HDG_KP", 3.0)
    storage.close()
    assert [stored.error for stored in parameters.poll_saves()] == ["params.parm: No space left on device"]
    assert parameters.poll_saves() == []
    assert parameters.config.heading.kp == 3.0


def test_many_are_set_with_one_save_and_the_refused_are_told() -> None:
    storage = MemoryStorage()
    parameters = Parameters(BoatConfig(), ROWS, storage)
    reasons = parameters.set_many([("HDG_KP", 3.5), ("NOT_THERE", 1.0), ("HDG_KI", 99.0), ("WP_RADIUS", 4.0)])
    assert reasons == ["HDG_KI: 99 is outside 0..50"]
    assert storage.load("params.parm") == b"HDG_KP 3.5\nWP_RADIUS 4\n"
    assert [set(stored.values) for stored in parameters.poll_saves()] == [{"HDG_KP", "WP_RADIUS"}]
    row = next(row for row in ROWS if row.name == "HDG_KP")
    assert (parameters.value(row), parameters.default(row)) == (3.5, 3.75)


def test_the_page_in_docs_is_what_the_table_says() -> None:
    """If not: boat-companion params --markdown > docs/parameters.md"""
    page = Path(__file__).parents[3] / "docs" / "parameters.md"
    assert page.read_text(encoding="utf-8") == parameter_page()
