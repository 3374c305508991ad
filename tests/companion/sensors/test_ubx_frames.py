"""UBX framing and messages against pyubx2, and against noise."""

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyubx2 import GET, SET, UBXMessage, UBXReader
from twins.lines import known
from twins.ubx_messages import Motion, nav_pvt, nav_relposned

from companion.sensors.ubx.configuration import (
    UART1,
    UART2,
    USB,
    Interface,
    LinePort,
    line_port,
    port_step,
    steps,
    value_step,
)
from companion.sensors.ubx.frames import CFG_PRT, MON_VER, UbxFrame, UbxReader, encode
from companion.sensors.ubx.messages import UbxFixAssembler, baseline, horizontal_dop, solution, version

PVT = nav_pvt(216_010_000, Motion())


def read_by_pyubx2(data: bytes) -> list[UBXMessage]:
    """Raises on anything malformed."""
    return [message for _, message in UBXReader(io.BytesIO(data), msgmode=SET, quitonerror=2)]


@given(st.lists(st.integers(1, 40)), st.binary(max_size=60).filter(lambda noise: b"\xb5" not in noise))
def test_frames_are_found_in_any_pieces_between_noise(cuts: list[int], noise: bytes) -> None:
    reader, stream = UbxReader(), noise + PVT + noise + encode(MON_VER) + noise
    frames: list[UbxFrame] = []
    between = b""
    while stream:
        size = cuts.pop() if cuts else len(stream)
        found, other = reader.feed(stream[:size])
        stream, frames, between = stream[size:], frames + found, between + other
    assert frames == [UbxFrame(0x0107, PVT[6:-2]), UbxFrame(MON_VER, b"")]
    assert between == 3 * noise
    assert reader.malformed == 0


@given(st.binary(max_size=400))
def test_noise_never_raises_and_a_frame_behind_it_is_found(noise: bytes) -> None:
    reader = UbxReader()
    reader.feed(noise)
    frames = [frame for _ in range(7) for frame in reader.feed(PVT)[0]]  # longer than any held frame
    assert UbxFrame(0x0107, PVT[6:-2]) in frames


def test_a_corrupted_byte_loses_one_frame_only() -> None:
    for at in range(len(PVT)):
        reader, wrong = UbxReader(), bytearray(PVT)
        wrong[at] ^= 0x10
        frames, _ = reader.feed(bytes(wrong) + 12 * PVT)
        assert frames.count(UbxFrame(0x0107, PVT[6:-2])) == 12


@given(st.binary(max_size=120))
def test_payloads_of_any_content_are_decoded_or_none(payload: bytes) -> None:
    for decode in (solution, horizontal_dop, baseline, line_port, version):
        decode(payload)


@pytest.mark.parametrize(("at", "date"), [(4, b"\xe8\xb0"), (4, b"\x00\x00"), (6, b"\x00"), (6, b"\x0d")])
def test_an_impossible_date_is_no_date(at: int, date: bytes) -> None:
    raw = bytearray(PVT[6:-2])
    raw[at : at + len(date)] = date
    pvt = known(solution(bytes(raw)))
    assert pvt.unix_time_s is None


def test_a_fix_has_the_time_of_day_of_its_week() -> None:
    fix = known(UbxFixAssembler(0.0).feed(UbxFrame(0x0107, PVT[6:-2]), 1.0))
    assert fix.time_of_day_s == 216_010.0 - 2 * 86_400.0


def test_a_normalised_baseline_is_no_heading() -> None:
    found = known(baseline(nav_relposned(216_000_250, Motion(length_m=1.23))[6:-2]))
    assert found.time_of_week_s == pytest.approx(216_000.25)
    assert found.length_m == pytest.approx(1.23)
    assert found.heading_rad is not None
    raw = bytearray(nav_relposned(0, Motion())[6:-2])
    raw[35] = 50  # relPosHPLength, 0.1 mm
    found = known(baseline(bytes(raw)))
    assert found.length_m == pytest.approx(1.005)
    raw[61] |= 0x02
    found = known(baseline(bytes(raw)))
    assert found.heading_rad is None


@pytest.mark.parametrize(
    ("extension", "protocol"), [("PROTVER=18.00", 18.0), ("PROTVER 14.00", 14.0), ("", 13.0)]
)
def test_the_protocol_version_decides_the_generation(extension: str, protocol: float) -> None:
    payload = b"x".ljust(30, b"\0") + b"00080000\0\0" + extension.encode().ljust(30, b"\0")
    assert version(payload).protocol == protocol


@pytest.mark.parametrize("interface", [UART1, UART2, USB])
def test_keys_are_those_of_the_interface_in_pyubx2s_data_base(interface: Interface) -> None:
    name = interface.name
    wanted = steps(27.5, interface, 10.0, wants_baseline=True)
    data = b"".join(step.frame for step in wanted)
    if interface.baud is not None:
        data += value_step("baud rate", {interface.baud: 115_200}).frame
    values: dict[str, int] = {}
    for message in read_by_pyubx2(data):
        assert (message.identity, message.ram, message.bbr, message.flash) == ("CFG-VALSET", 1, 0, 0)
        values |= {key: value for key, value in vars(message).items() if key.startswith("CFG_")}
    baud = {} if interface.baud is None else {f"CFG_{name}_BAUDRATE": 115_200}
    assert values == baud | {
        f"CFG_{name}INPROT_UBX": 1,
        f"CFG_{name}INPROT_RTCM3X": 1,
        f"CFG_{name}OUTPROT_UBX": 1,
        f"CFG_{name}OUTPROT_NMEA": 0,
        f"CFG_MSGOUT_UBX_NAV_PVT_{name}": 1,
        f"CFG_MSGOUT_UBX_NAV_DOP_{name}": 1,
        f"CFG_MSGOUT_UBX_NAV_RELPOSNED_{name}": 1,
        "CFG_RATE_MEAS": 100,
        "CFG_RATE_NAV": 1,
        "CFG_NAVSPG_DYNMODEL": 5,
    }


def test_the_legacy_messages_say_the_same_to_pyubx2() -> None:
    port = LinePort(1, 0, 0x8D0, 9600, 0x07, 0x03, 0)
    wanted = [*steps(18.0, UART1, 10.0, False), port_step(port, 115_200, 18.0, ends_nmea=True)]
    rate, nav5, pvt, dop, prt = read_by_pyubx2(b"".join(step.frame for step in wanted))
    assert (rate.measRate, rate.navRate) == (100, 1)
    assert (nav5.dyn, nav5.dynModel, nav5.minEl, nav5.posFixMode, nav5.utc) == (1, 5, 0, 0, 0)
    assert (pvt.msgClass, pvt.msgID, dop.msgID) == (0x01, 0x07, 0x04)
    assert (prt.portID, prt.baudRate, prt.charLen, prt.nStopBits) == (1, 115_200, 3, 0)
    assert (prt.inUBX, prt.inNMEA, prt.outUBX, prt.outNMEA) == (1, 1, 1, 0)
    assert prt.inRTCM3 == 0  # not before protocol 20
    m8p = UBXReader.parse(port_step(port, 115_200, 20.0).frame, msgmode=SET)
    assert (m8p.inRTCM3, m8p.outNMEA) == (1, 1)


def test_a_port_is_read_as_pyubx2_writes_it() -> None:
    written = UBXMessage("CFG", "CFG-PRT", GET, portID=1, baudRate=38400, inUBX=1, outNMEA=1, charLen=3)
    port = known(line_port(written.serialize()[6:-2]))
    assert (port.number, port.baud, port.in_protocols, port.out_protocols) == (1, 38400, 1, 2)
    assert encode(CFG_PRT) == b"\xb5\x62\x06\x00\x00\x00\x06\x18"
