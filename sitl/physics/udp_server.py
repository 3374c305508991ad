"""The UDP server of the JSON interface."""

import socket
from collections.abc import Callable
from contextlib import suppress

from companion.core.errors import LinkError
from sitl.physics.backend import Backend

PORT = 9002  # where ArduPilot sends its servo outputs unless it is told --sim-port-out
_LOOK_S = 0.2  # interval of checks for a stop while nothing arrives
_DATAGRAM_BYTES = 2048


class PhysicsServer:
    """One socket for one autopilot. told: is called with the address of each new one."""

    def __init__(self, backend: Backend, host: str = "127.0.0.1", port: int = PORT) -> None:
        """Open the port; 0 takes a free one. Raises LinkError: the system refuses the port."""
        self._backend = backend
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise LinkError(f"cannot listen on {host}:{port}: {error.strerror}") from None
        self._socket.settimeout(_LOOK_S)

    @property
    def port(self) -> int:
        """The one that is open."""
        return int(self._socket.getsockname()[1])

    def run(self, should_stop: Callable[[], bool], told: Callable[[str], None] = lambda _: None) -> None:
        """Answer until told to stop; then close."""
        last = None
        with self._socket:
            while not should_stop():
                try:
                    data, address = self._socket.recvfrom(_DATAGRAM_BYTES)
                except (TimeoutError, ConnectionError):  # nothing came, or the autopilot has ended
                    continue
                reply = self._backend.handle(data)
                if reply is None:
                    continue
                if address != last:
                    last = address
                    told(f"{address[0]}:{address[1]}")
                with suppress(OSError):  # it asks again
                    self._socket.sendto(reply, address)
