"""A serial line: a radio, a USB adapter, the Pi's UART."""

import contextlib
import os
import stat
import termios
from collections.abc import Callable
from typing import NamedTuple

import serial

from companion.core.errors import LinkError
from companion.links.interfaces import Link
from companion.links.retried import Backoff
from companion.links.stream import StreamLink

_QUEUE_BYTES = 8192
_VMIN, _VTIME = 1, 0

# Errors of a device unplugged during set-up; termios.error is not an OSError, and pyserial passes it on.
_REFUSALS = (serial.SerialException, termios.error, ValueError, OSError)


class LineFormat(NamedTuple):
    """Framing on the wire. With a parity, bytes with a parity error are dropped. is_ready: level of DTR."""

    parity: str = serial.PARITY_NONE
    stop_bits: int = serial.STOPBITS_ONE
    has_flow_control: bool = False  # by RTS and CTS
    is_ready: bool = True


LINE_8N1 = LineFormat()
LINE_8E2 = LineFormat(serial.PARITY_EVEN, serial.STOPBITS_TWO)


class SerialPort:
    """`serial:DEVICE:BAUD`: one link at a time, and a new one when the device is plugged in again.

    pyserial configures the line; data is moved through the descriptor, which never blocks.
    Raises LinkError: the device is missing, not accessible, or in use.
    """

    def __init__(
        self,
        device: str,
        baud: int,
        now: Callable[[], float],
        queue_bytes: int = _QUEUE_BYTES,
        line: LineFormat = LINE_8N1,
    ) -> None:
        self._device = device
        self._line = line
        self._baud = baud
        self._now = now
        self._queue_bytes = queue_bytes
        self.name = f"serial:{device}:{baud}"
        self._serial: serial.Serial | None = None
        self._backoff = Backoff(longest_s=2.0)
        self._is_closed = False
        self._link = self._open()
        self._fresh: list[Link] = [self._link]

    def accept(self) -> list[Link]:
        """The first link, and a new one after each reconnection."""
        if self._link.is_closed and not self._is_closed:
            now_s = self._now()
            if self._backoff.is_due(now_s):
                self._backoff.failed(now_s)
                try:
                    self._link = self._open()
                except LinkError:
                    pass
                else:
                    self._fresh.append(self._link)
        fresh, self._fresh = self._fresh, []
        return fresh

    def set_baud(self, baud: int) -> None:
        """Change the baud rate, now and for each reconnection. A device that refuses it is closed."""
        self._baud = baud
        if self._serial is None or self._link.is_closed:
            return
        try:
            self._serial.baudrate = baud
            self._set_up(self._serial)
        except _REFUSALS:
            self._link.close()

    def fileno(self) -> int:
        """−1: `accept` polls for the device."""
        return -1

    def close(self) -> None:
        self._is_closed = True
        self._link.close()

    def _open(self) -> StreamLink:
        line: serial.Serial | None = None
        try:
            line = serial.Serial(
                baudrate=self._baud,
                parity=self._line.parity,
                stopbits=self._line.stop_bits,
                rtscts=self._line.has_flow_control,
                timeout=0,
                write_timeout=0,
                exclusive=True,
            )
            line.dtr, line.port = self._line.is_ready, self._device
            line.open()
            descriptor = self._set_up(line)
        except _REFUSALS as error:
            if line is not None:
                with contextlib.suppress(OSError):
                    line.close()
            raise LinkError(f"{self.name}: {self._reason(error)}") from None
        self._backoff.succeeded()
        self._serial = line
        return StreamLink(self.name, descriptor, line.close, self._queue_bytes)

    def _set_up(self, line: serial.Serial) -> int:
        descriptor: int = line.fileno()
        os.set_blocking(descriptor, False)
        # With VMIN 1 an idle line returns EAGAIN, and only an unplugged one end of file.
        attributes = termios.tcgetattr(descriptor)
        attributes[6][termios.VMIN], attributes[6][termios.VTIME] = _VMIN, _VTIME
        if self._line.parity != serial.PARITY_NONE:
            attributes[0] |= termios.INPCK | termios.IGNPAR
        termios.tcsetattr(descriptor, termios.TCSANOW, attributes)
        return descriptor

    def _reason(self, error: Exception) -> str:
        try:
            mode = os.stat(self._device).st_mode
        except OSError:  # it may be unplugged
            return f"there is no device {self._device}; is it plugged in?"
        if not stat.S_ISCHR(mode):
            return f"{self._device} is not a serial device"
        if not os.access(self._device, os.R_OK | os.W_OK):
            return f"no permission for {self._device}; add the user to the group 'dialout'"
        if "exclusively lock" in str(error):
            return f"{self._device} is in use by another program"
        return f"cannot be opened: {error.args[-1] if error.args else error}"
