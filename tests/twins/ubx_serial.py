"""A u-blox receiver at the far end of a pseudo-terminal."""

import termios
import threading
import time
from typing import Self

from twins.lines import PtyLine
from twins.ubx_receiver import UbxReceiver

_RATES = {
    getattr(termios, f"B{rate}"): rate for rate in (4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800)
}


class SerialReceiver:
    """A receiver at the far end of a pseudo-terminal."""

    def __init__(self, line: PtyLine, receiver: UbxReceiver) -> None:
        self.line = line
        self.receiver = receiver

        self._is_off = threading.Event()
        self._thread = threading.Thread(target=self._run, name="receiver", daemon=True)

    def __enter__(self) -> Self:
        """Run in a thread."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._is_off.set()
        self._thread.join(5.0)

    def _run(self) -> None:
        while not self._is_off.wait(0.005):
            self.run()

    def run(self) -> None:
        """Move what has come and what is due."""
        try:
            rate = _RATES.get(termios.tcgetattr(self.line._master)[5])
        except termios.error:
            return
        heard = self.line.heard()
        if heard and rate == self.receiver.baud:
            self.receiver.hear(heard)
        sent = self.receiver.run(time.monotonic())
        if sent:
            self.line.say(sent if rate == self.receiver.baud else bytes(len(sent)))
