"""Bad lines between a station and a boat's TCP, by a seed."""

import select
import socket
import threading
import time

from patience import MOMENT_S
from pymavlink.dialects.v20 import all as dialect

from sitl.radio.channel import Channel, Quality

_LONGEST_WAIT_S = 0.02


class LossyRelay:
    """From the station's UDP: loses, delays, doubles and reorders whole frames.

    A thread of its own; a station connects to `port` on this machine.
    """

    def __init__(self, boat_port: int, quality: Quality, seed: int) -> None:
        self._up, self._down = Channel(quality, seed), Channel(quality, seed + 1)
        self._station: tuple[str, int] | None = None
        self._near = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._near.bind(("127.0.0.1", 0))
        self._far = socket.create_connection(("127.0.0.1", boat_port), timeout=MOMENT_S)
        self._far.settimeout(None)
        self._reader = dialect.MAVLink(None)
        self._reader.robust_parsing = True
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """Where the station finds the boat."""
        return int(self._near.getsockname()[1])

    def improve(self) -> None:
        """From now on the line is perfect."""
        self._up.quality = self._down.quality = Quality()

    def close(self) -> None:
        """Hang up both."""
        self._is_over.set()
        self._thread.join(MOMENT_S)
        self._near.close()
        self._far.close()

    def _run(self) -> None:
        while not self._is_over.is_set():
            wait_s = min(self._up.next_s, self._down.next_s) - time.monotonic()
            ready, _, _ = select.select(
                [self._near, self._far], [], [], max(0.0, min(wait_s, _LONGEST_WAIT_S))
            )
            now_s = time.monotonic()
            if self._near in ready:
                data, self._station = self._near.recvfrom(65536)
                self._up.send(data, now_s)
            if self._far in ready:
                data = self._far.recv(65536)
                if not data:
                    return
                for message in self._reader.parse_buffer(data) or []:
                    self._down.send(bytes(message.get_msgbuf()), now_s)
            for data in self._up.receive(now_s):
                self._far.sendall(data)
            if self._station is not None:
                for data in self._down.receive(now_s):
                    self._near.sendto(data, self._station)
