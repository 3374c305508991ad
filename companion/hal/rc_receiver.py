"""RC receivers on a UART: CRSF (ExpressLRS, Crossfire), iBUS, S.BUS."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

from companion.config.tuning import Rc
from companion.core.errors import ConfigError
from companion.core.readings import RcReading
from companion.hal.port_sensor import PortSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.links.serial_port import LINE_8E2, LINE_8N1, LineFormat
from companion.rc.parsers import CrsfParser, IbusParser, RcParser, SbusParser


class _Protocol(NamedTuple):
    parser: type[RcParser]
    line: LineFormat
    rest_s: float


_PROTOCOLS = {
    # A rest shorter than the boat's tick: of up to 500 frames a second the boat uses 50.
    "crsf": _Protocol(CrsfParser, LINE_8N1, 0.015),
    "ibus": _Protocol(IbusParser, LINE_8N1, 0.015),
    "sbus": _Protocol(SbusParser, LINE_8E2, 0.0),  # frames are separated by pauses
}


class SerialRcReceiver(PortSensor[RcReading]):
    """Satisfies `companion.hal.interfaces.RcReceiver`. Readings are stamped when read."""

    def __init__(self, port: Port, now: Callable[[], float], parser: RcParser, rest_s: float = 0.0) -> None:
        super().__init__(port, now, rest_s)
        self.parser = parser

    def _decode(self, chunk: bytes, time_s: float) -> Iterable[RcReading]:
        reading = self.parser.feed(chunk, time_s)
        return () if reading is None else (reading,)

    def _forget(self) -> None:
        self.parser.forget()


def open_rc_receiver(setting: Rc, now: Callable[[], float]) -> SerialRcReceiver:
    """Open the receiver on its port and start reading. The port is a device or a port url.
    Raises ConfigError: the port url is invalid, or no driver is named; LinkError: the port cannot be opened.
    """
    protocol = _PROTOCOLS.get(setting.driver)
    if protocol is None:
        raise ConfigError(f"rc.driver = {setting.driver!r}: expected one of {', '.join(_PROTOCOLS)}")
    port = open_line(setting.port, protocol.parser.baud, now, protocol.line)
    return SerialRcReceiver(port, now, protocol.parser(), protocol.rest_s).start()
