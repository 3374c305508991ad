"""Candidates for the baud rate of a receiver."""

from struct import Struct
from typing import Final, NamedTuple

from companion.sensors.ubx.frames import (
    CFG_MSG,
    CFG_NAV5,
    CFG_PRT,
    CFG_RATE,
    CFG_VALSET,
    NAV_DOP,
    NAV_PVT,
    encode,
)

# Factory rates (u-blox 9: 38,400; before: 9600), then those that people set
BAUD_RATES: Final = (9600, 38400, 115200, 57600, 230400, 19200, 460800, 4800)


class BaudSearch:
    """Goes round all rates, the present one first, then the wanted one."""

    def __init__(self, present: int | None, wanted: int | None) -> None:
        """None for a line without a baud rate."""
        self._rates: list[int | None] = [present]
        if present is not None:
            others = dict.fromkeys((wanted, *BAUD_RATES))
            self._rates += [rate for rate in others if rate != present]
        self._tried = 0

    def next(self) -> int | None:
        """The candidate after the present one."""
        self._tried += 1
        return self._rates[self._tried % len(self._rates)]

    @property
    def is_round(self) -> bool:
        """Whether all rates have been tried equally often."""
        return self._tried % len(self._rates) == 0


KEYS_FROM: Final = 27.0  # protocol version with CFG-VALSET: u-blox 9 and later
PVT_FROM: Final = 14.0  # with NAV-PVT: u-blox 7 and later
_RTCM_FROM: Final = 20.0  # with RTCM 3 input among the legacy protocols
_SEA: Final = 5  # dynamic model
_UBX, _NMEA, _RTCM3 = 0x01, 0x02, 0x20  # protocol masks of CFG-PRT
_PRT: Final = Struct("<BxHIIHHH2x")
_UARTS: Final = (1, 2)
_NMEA_CLASS: Final = 0xF000
_GGA, _GLL, _GSA, _GSV, _RMC, _VTG, _GST = 0, 1, 2, 3, 4, 5, 7  # NMEA message ids

# What an epoch takes on the line: NAV-PVT and NAV-DOP; NAV-RELPOSNED; the sentences above
_UBX_BYTES, _BASELINE_BYTES, _NMEA_BYTES = 126, 72, 260
_BITS_A_BYTE, _LINE_SHARE = 10, 0.8  # the rest is for answers

_RAM: Final = b"\x00\x01\x00\x00"  # CFG-VALSET: version 0, layer RAM
_VALUE_BYTES: Final = {1: 1, 2: 1, 3: 2, 4: 4}  # by the size bits of a key
_RATE_MEAS, _RATE_NAV, _DYNAMIC_MODEL = 0x30210001, 0x30210002, 0x20110021
# Keys of the outputs for I2C; UART1, UART2 and USB follow
_OUT_PVT, _OUT_DOP, _OUT_RELPOSNED = 0x20910006, 0x20910038, 0x2091008D


class Interface(NamedTuple):
    """A port of the receiver: its offset in the output keys, and its other keys."""

    name: str
    output: int
    in_protocols: int
    out_protocols: int
    baud: int | None


UART1: Final = Interface("UART1", 1, 0x10730000, 0x10740000, 0x40520001)
UART2: Final = Interface("UART2", 2, 0x10750000, 0x10760000, 0x40530001)
USB: Final = Interface("USB", 3, 0x10770000, 0x10780000, None)


class UbxStep(NamedTuple):
    """One message that the receiver acknowledges. A refusal of one that is not required is not reported.

    ends_nmea: only after all required steps are acknowledged; sentences are the fallback.
    """

    what: str
    kind: int
    payload: bytes
    is_required: bool = True
    ends_nmea: bool = False

    @property
    def frame(self) -> bytes:
        """As it goes over the line."""
        return encode(self.kind, self.payload)


def rate_on_line(rate_hz: float, baud: int | None, protocol: float, wants_baseline: bool) -> float:
    """The wanted rate, or what a slow line carries of it in whole Hz. baud: None for USB."""
    if baud is None:
        return rate_hz
    size = _NMEA_BYTES if protocol < PVT_FROM else _UBX_BYTES + wants_baseline * _BASELINE_BYTES
    return min(rate_hz, max(_LINE_SHARE * baud / _BITS_A_BYTE // size, 1.0))


def steps(protocol: float, interface: Interface, rate_hz: float, wants_baseline: bool) -> list[UbxStep]:
    """All that is set after the baud rate. interface: used by keys; legacy messages mean the line's own."""
    if protocol >= KEYS_FROM:
        return _steps_by_keys(interface, rate_hz, wants_baseline)
    period_ms = round(1000.0 / rate_hz)
    result = [
        UbxStep("navigation rate", CFG_RATE, Struct("<HHH").pack(period_ms, 1, 0)),
        UbxStep("sea model", CFG_NAV5, Struct("<HB33x").pack(0x0001, _SEA)),
    ]
    if protocol >= PVT_FROM:
        outputs = {NAV_PVT: 1, NAV_DOP: 1}
    else:
        nmea = {_GGA: 1, _RMC: 1, _GSA: 1, _GST: 1, _GSV: 0, _GLL: 0, _VTG: 0}
        outputs = {_NMEA_CLASS + number: rate for number, rate in nmea.items()}
    return result + [
        UbxStep("output of messages", CFG_MSG, kind.to_bytes(2, "big") + bytes((rate,)))
        for kind, rate in outputs.items()
    ]


def _steps_by_keys(interface: Interface, rate_hz: float, wants_baseline: bool) -> list[UbxStep]:
    output = interface.output
    result = [
        value_step(
            "output of messages",
            {
                interface.in_protocols + 1: 1,
                interface.out_protocols + 1: 1,
                _OUT_PVT + output: 1,
                _OUT_DOP + output: 1,
            },
        ),
        value_step("navigation rate", {_RATE_MEAS: round(1000.0 / rate_hz), _RATE_NAV: 1}),
        value_step("sea model", {_DYNAMIC_MODEL: _SEA}),
        value_step("RTCM input", {interface.in_protocols + 4: 1}, is_required=False),
    ]
    if wants_baseline:
        result.append(value_step("output of NAV-RELPOSNED", {_OUT_RELPOSNED + output: 1}))
    result.append(
        value_step("NMEA output", {interface.out_protocols + 2: 0}, is_required=False, ends_nmea=True)
    )
    return result


def value_step(
    what: str, values: dict[int, int], *, is_required: bool = True, ends_nmea: bool = False
) -> UbxStep:
    """CFG-VALSET. A receiver that does not know one of the keys refuses them all."""
    data = b"".join(
        key.to_bytes(4, "little") + value.to_bytes(_VALUE_BYTES[key >> 28 & 7], "little")
        for key, value in values.items()
    )
    return UbxStep(what, CFG_VALSET, _RAM + data, is_required, ends_nmea)


class LinePort(NamedTuple):
    """CFG-PRT of the port that was polled: what is set at present."""

    number: int
    ready_pin: int
    mode: int
    baud: int
    in_protocols: int
    out_protocols: int
    flags: int

    @property
    def is_uart(self) -> bool:
        """Whether it has a baud rate."""
        return self.number in _UARTS


def line_port(payload: bytes) -> LinePort | None:
    """Decode a CFG-PRT; None if it is malformed."""
    return LinePort(*_PRT.unpack(payload)) if len(payload) == _PRT.size else None


def port_step(port: LinePort, baud: int, protocol: float, *, ends_nmea: bool = False) -> UbxStep:
    """CFG-PRT: the baud rate, UBX (and RTCM) in, UBX and NMEA out."""
    changed = port._replace(
        baud=baud if port.is_uart else port.baud,
        in_protocols=port.in_protocols | _UBX | (_RTCM3 if protocol >= _RTCM_FROM else 0),
        out_protocols=_UBX if ends_nmea else _UBX | _NMEA,
    )
    return UbxStep(
        "NMEA output" if ends_nmea else "port", CFG_PRT, _PRT.pack(*changed), not ends_nmea, ends_nmea
    )
