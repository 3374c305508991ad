"""RC receivers on a UART: CRSF (ExpressLRS, Crossfire), iBUS, S.BUS."""

from collections.abc import Callable
from typing import NamedTuple

from companion.config.tuning import Rc
from companion.core.errors import ConfigError
from companion.core.readings import RcReading
from companion.hal.port_sensor import ParsedSensor
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


def open_rc_receiver(setting: Rc, now: Callable[[], float]) -> ParsedSensor[RcReading]:
    """Open the receiver on its port and start reading. The port is a device or a port url.
    Raises ConfigError: the port url is invalid, or no driver is named; LinkError: the port cannot be opened.
    """
    protocol = _PROTOCOLS.get(setting.driver)
    if protocol is None:
        raise ConfigError(f"rc.driver = {setting.driver!r}: expected one of {', '.join(_PROTOCOLS)}")
    port = open_line(setting.port, protocol.parser.baud, now, protocol.line)
    return ParsedSensor(port, now, protocol.parser(), protocol.rest_s).start()
