"""What QGroundControl's pages show of the boat's parameters, read by its rules (`qgc_metadata`)."""

from boat_rig import BOAT, Rig
from ftp_client import Served
from qgc_metadata import read, unpacked

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.storage import MemoryStorage
from companion.mavlink.dialect import dialect

# What the pages of QGroundControl 4.4 ask of a Rover; without it they open with a warning.
AIRFRAME = {"FRAME_CLASS", "FRAME_TYPE"}
RADIO = {"RCMAP_ROLL", "RCMAP_PITCH", "RCMAP_YAW", "RCMAP_THROTTLE"} | {
    f"RC{number}_{what}" for number in (1, 2, 3, 4) for what in ("MIN", "MAX", "TRIM")
}
FLIGHT_MODES = {"MODE_CH", *(f"MODE{number}" for number in range(1, 7))} | {
    f"RC{number}_OPTION" for number in range(6, 17)
}
SENSORS = {
    "AHRS_ORIENTATION", "COMPASS_DEC", "COMPASS_AUTODEC", "INS_ACCOFFS_X", "INS_ACCOFFS_Y", "INS_ACCOFFS_Z",
    *(f"COMPASS_DEV_ID{number}" for number in ("", 2, 3)),
    *(f"COMPASS_USE{number}" for number in ("", 2, 3)),
    *(f"COMPASS_OFS{number}_{axis}" for number in ("", 2, 3) for axis in "XYZ"),
    # once the first is there, it asks for all three; without it the Summary calls the compass unused
    "COMPASS_PRIO1_ID", "COMPASS_PRIO2_ID", "COMPASS_PRIO3_ID",
}  # fmt: skip
COMPASS_CALIBRATION = {"COMPASS_CAL_FIT"}  # read and written once the first step has been accepted
POWER = {"BATT_MONITOR", "BATT_CAPACITY", "BATT_ARM_VOLT", "BATT2_MONITOR"}
SAFETY = {"FS_GCS_ENABLE", "FS_THR_ENABLE", "FS_THR_VALUE", "FS_ACTION", "FS_CRASH_CHECK", "ARMING_CHECK"}
FLY_VIEW = {"WPNAV_SPEED", "WP_SPEED"}  # the speed slider's end: the one of 4.4, the one of later versions
NAME = "parameters.json.xz"
FACTS = read(unpacked(NAME, Served().get(f"/metadata/{NAME}".encode())))


def sent_by(rig: Rig) -> dict[str, float]:
    """All parameters as they come over the wire."""
    rig.step()
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_param_request_list_message(*BOAT))
    rig.receive()
    rig.run(1.0)
    return {one.param_id.rstrip("\0"): one.param_value for one in rig.peer.said("PARAM_VALUE")}


def test_no_page_misses_a_parameter_and_each_has_a_text_and_is_shown_as_unchanged_on_a_fresh_boat() -> None:
    rig = Rig()
    values = sent_by(rig)
    for page in (AIRFRAME, RADIO, FLIGHT_MODES, SENSORS, COMPASS_CALIBRATION, POWER, SAFETY, FLY_VIEW):
        assert page <= set(values)
    # The scenario's boat differs from the usual one in some
    own, usual = (Parameters(config, ROWS, MemoryStorage()) for config in (rig.config, BoatConfig()))
    different = {row.name for row in ROWS if own.value(row) != usual.value(row)}
    assert {name for name, fact in FACTS.items() if not fact.is_default(values[name])} == different
    assert all(fact.text for fact in FACTS.values())
