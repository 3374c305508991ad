"""A u-blox receiver below the driver, as its interface descriptions say.

Sources: UBX-13003221 (M8), sections 32.9 "UBX-ACK" and 32.11 "UBX-CFG"; UBX-22008968 (ZED-F9P), sections 3.10
and 5.
pyubx2 writes its messages and reads those of the host, so neither side uses the driver's code.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from pyubx2 import GET, POLL, SET, UBXMessage, UBXReader

from twins.ubx_messages import Motion, nav_pvt, nav_relposned, sentence

BITS_A_BYTE = 10
_SWITCH = {1: "UART1", 2: "UART2", 3: "USB"}


@dataclass(frozen=True)
class Model:
    """A product: factory settings and abilities."""

    software: str
    hardware: str
    extensions: tuple[str, ...]
    baud: int
    protocol: float
    ports: tuple[str, ...] = ("UART1", "USB")
    has_baseline: bool = False
    has_rtcm: bool = False


NEO_6M = Model("7.03 (45969)", "00040007", (), 9600, 13.0)
NEO_M8N = Model(
    "ROM CORE 3.01 (107888)",
    "00080000",
    ("FWVER=SPG 3.01", "PROTVER=18.00", "GPS;GLO;GAL;BDS", "SBAS;IMES;QZSS"),
    9600,
    18.0,
)
ZED_F9P = Model(
    "EXT CORE 1.00 (f17067)",
    "00190000",
    ("ROM BASE 0x118B2060", "FWVER=HPG 1.50", "PROTVER=27.50", "MOD=ZED-F9P"),
    38400,
    27.5,
    ("UART1", "UART2", "USB"),
    has_baseline=True,
    has_rtcm=True,
)
MAX_M10 = Model(
    "ROM SPG 5.10 (7b202e)", "000A0000", ("FWVER=SPG 5.10", "PROTVER=34.10"), 9600, 34.1, ("UART1",)
)

# Keys by name of the interface: input of UBX and RTCM 3, output of UBX and NMEA, baud rate; offset of outputs
_KEYS = {
    "UART1": (0x10730001, 0x10730004, 0x10740001, 0x10740002, 0x40520001, 1),
    "UART2": (0x10750001, 0x10750004, 0x10760001, 0x10760002, 0x40530001, 2),
    "USB": (0x10770001, 0x10770004, 0x10780001, 0x10780002, None, 3),
}
_PVT, _DOP, _RELPOSNED = 0x20910006, 0x20910038, 0x2091008D
_RATE_MEAS, _RATE_NAV, _DYNMODEL = 0x30210001, 0x30210002, 0x20110021
_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8}


@dataclass
class Settings:
    """The volatile settings."""

    baud: int
    period_ms: int = 1000
    model: int = 0
    outputs: dict[str, int] = field(default_factory=dict)  # messages of the line's interface
    ubx_out: bool = True
    nmea_out: bool = True
    rtcm_in: bool = False


class UbxReceiver:
    """deaf: its RX is not connected; refused: kinds (class, id) or keys answered by NAK."""

    def __init__(
        self, model: Model, *, interface: str = "UART1", baud: int | None = None, bursts: bool = False
    ) -> None:
        self.model = model
        self.interface = interface
        self.saved_baud = baud or model.baud
        self.motion = Motion()
        self.is_deaf = False
        self.unacknowledged = False
        self.refused: set[object] = set()
        self.other_layers: list[int] = []
        self.rtcm = b""
        self._out = bytearray()
        self._held = b""
        self._next_s: float | None = None
        self._sent_s = 0.0
        self._budget = 0.0
        self.settings = self._factory()

    def _factory(self) -> Settings:
        return Settings(self.saved_baud, outputs={})

    @property
    def baud(self) -> int | None:
        """The rate of its line; None on USB."""
        return None if self.interface == "USB" else self.settings.baud

    def dip(self) -> None:
        """Power fails for an instant: all volatile settings are lost, and the buffers."""
        self.settings = self._factory()
        self._out.clear()
        self._held = b""
        self._next_s = None

    def run(self, now_s: float) -> bytes:
        """What it puts on the line until now_s, at its baud rate."""
        dt, self._sent_s = now_s - self._sent_s, now_s
        if self._next_s is None:
            self._next_s = now_s + 0.5  # start-up
        while self._next_s <= now_s:
            self._out += b"".join(self._epoch(self._next_s))
            self._next_s += 1e-3 * self.settings.period_ms
        if self.baud is None:
            sent = bytes(self._out)
        else:
            self._budget = min(self._budget + dt * self.baud / BITS_A_BYTE, 0.1 * self.baud)
            sent = bytes(self._out[: int(self._budget)])
            self._budget -= len(sent)
        del self._out[: len(sent)]
        del self._out[:-4096]  # its transmit buffer
        return sent

    def hear(self, data: bytes) -> None:
        """Bytes from the host, at the right baud rate."""
        if self.is_deaf:
            return
        self._held += data
        while (at := self._held.find(b"\xb5\x62")) >= 0 and len(self._held) >= at + 6:
            end = at + 8 + int.from_bytes(self._held[at + 4 : at + 6], "little")
            if len(self._held) < end:
                return
            raw, self._held = self._held[at:end], self._held[end:]
            self._take(raw)
        if at < 0:
            if self.settings.rtcm_in or self.model.protocol < 27:
                self.rtcm += self._held
            self._held = b""

    def _take(self, raw: bytes) -> None:
        cls, number, payload = raw[2], raw[3], raw[6:-2]
        UBXReader.parse(raw, msgmode=SET if payload else POLL)  # raises on a wrong checksum
        if (cls, number) == (0x0A, 0x04):
            self._say(0x0A, 0x04, self._version())
        elif (cls, number) == (0x06, 0x00) and not payload and self.model.protocol < 27:
            self._say(0x06, 0x00, self._port())
            self._acknowledge(cls, number, True)
        elif cls == 0x06:
            taken = (cls, number) not in self.refused and self._configure(number, payload)
            self._acknowledge(cls, number, taken)

    def _configure(self, number: int, payload: bytes) -> bool:
        keys = self.model.protocol >= 27
        settings = self.settings
        if number == 0x8A and keys:
            return self._set_values(payload)
        if keys:
            return False
        if number == 0x00 and len(payload) == 20:
            settings.baud = int.from_bytes(payload[8:12], "little") or settings.baud
            out = int.from_bytes(payload[14:16], "little")
            settings.ubx_out, settings.nmea_out = bool(out & 1), bool(out & 2)
            return True
        if number == 0x08 and len(payload) == 6:
            settings.period_ms = int.from_bytes(payload[:2], "little")
            return settings.period_ms >= 50
        if number == 0x24 and len(payload) == 36:
            if payload[0] & 1:
                settings.model = payload[2]
            return True
        if number == 0x01 and len(payload) == 3:
            if payload[0] == 0xF0:
                settings.outputs[f"NMEA{payload[1]}"] = payload[2]
                return True
            name = {b"\x01\x07": "PVT", b"\x01\x04": "DOP"}.get(payload[:2])
            if name is None or self.model.protocol < 14:
                return False
            settings.outputs[name] = payload[2]
            return True
        return False

    def _set_values(self, payload: bytes) -> bool:
        if payload[1] != 1:
            self.other_layers.append(payload[1])
        values, at = {}, 4
        while at < len(payload):
            key = int.from_bytes(payload[at : at + 4], "little")
            size = _SIZES[key >> 28 & 7]
            values[key] = int.from_bytes(payload[at + 4 : at + 4 + size], "little")
            at += 4 + size
        if not values.keys() <= self._known_keys() or self.refused & values.keys():
            return False
        _, rtcm_in, ubx_out, nmea_out, baud, offset = _KEYS[self.interface]
        settings = self.settings
        for key, value in values.items():
            if key == _RATE_MEAS:
                settings.period_ms = value
            elif key == _DYNMODEL:
                settings.model = value
            elif key == baud:
                settings.baud = value
            elif key == rtcm_in:
                settings.rtcm_in = bool(value)
            elif key == ubx_out:
                settings.ubx_out = bool(value)
            elif key == nmea_out:
                settings.nmea_out = bool(value)
            for base, name in ((_PVT, "PVT"), (_DOP, "DOP"), (_RELPOSNED, "RELPOSNED")):
                if key == base + offset:
                    settings.outputs[name] = value
        return True

    def _known_keys(self) -> set[int]:
        known = {_RATE_MEAS, _RATE_NAV, _DYNMODEL}
        for port in self.model.ports:
            ubx_in, rtcm_in, ubx_out, nmea_out, baud, offset = _KEYS[port]
            known |= {ubx_in, ubx_out, nmea_out, _PVT + offset, _DOP + offset}
            known |= {baud} if baud else set()
            known |= {rtcm_in} if self.model.has_rtcm else set()
            known |= {_RELPOSNED + offset} if self.model.has_baseline else set()
        return known

    def _acknowledge(self, cls: int, number: int, taken: bool) -> None:
        if not self.unacknowledged:
            self._say(0x05, 0x01 if taken else 0x00, bytes((cls, number)))

    def _say(self, cls: int, number: int, payload: bytes) -> None:
        if self.settings.ubx_out:
            self._out += UBXMessage(bytes((cls,)), bytes((number,)), GET, payload=payload).serialize()

    def _version(self) -> bytes:
        texts = [
            (self.model.software, 30),
            (self.model.hardware, 10),
            *((e, 30) for e in self.model.extensions),
        ]
        return b"".join(text.encode().ljust(width, b"\0") for text, width in texts)

    def _port(self) -> bytes:
        number = {name: key for key, name in _SWITCH.items()}[self.interface]
        out = self.settings.ubx_out + 2 * self.settings.nmea_out
        baud = self.settings.baud if number < 3 else 0
        words = (0x8D0).to_bytes(4, "little") + baud.to_bytes(4, "little")
        return bytes((number, 0, 0, 0)) + words + bytes((7, 0, out, 0, 0, 0, 0, 0))

    def _epoch(self, time_s: float) -> Iterator[bytes]:
        settings, motion = self.settings, self.motion
        tow_ms = round(time_s * 1e3) + 216_000_000
        if settings.ubx_out and settings.outputs.get("PVT"):
            yield nav_pvt(tow_ms, motion)
        if settings.ubx_out and settings.outputs.get("DOP"):
            yield UBXMessage("NAV", "NAV-DOP", GET, iTOW=tow_ms, hDOP=0.85, pDOP=1.6).serialize()
        if settings.ubx_out and settings.outputs.get("RELPOSNED"):
            yield nav_relposned(tow_ms, motion)
        if settings.nmea_out:
            yield from self._sentences(time_s)

    def _sentences(self, time_s: float) -> Iterator[bytes]:
        clock = f"{9 + int(time_s) // 3600:02}{int(time_s) // 60 % 60:02}{time_s % 60:05.2f}"
        place = "5030.0,N,00112.0,W"
        bodies = {
            4: f"GPRMC,{clock},A,{place},2.0,90.0,280524,,,A",
            0: f"GPGGA,{clock},{place},1,9,0.85,12.5,M,47.0,M,,",
            3: "GPGSV,1,1,04,01,40,083,46,02,17,308,41,12,07,344,39,14,22,228,45",
            7: f"GPGST,{clock},1.0,,,,1.5,2.0,3.0",
        }
        for number, body in bodies.items():
            if self.settings.outputs.get(f"NMEA{number}", number != 7):
                yield sentence(body)
