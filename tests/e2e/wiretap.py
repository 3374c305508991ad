"""A wire between a client and the boat that is listened to, and can be cut."""

import contextlib
import selectors
import socket
import threading
from collections.abc import Callable
from typing import Any, Self

from pymavlink.dialects.v20 import all as dialect

Listener = Callable[[Any], object]


class Wiretap:
    """Passes bytes between one client and the boat, in its own thread, and keeps what the client says."""

    def __init__(self, boat_port: int, on_message: Listener = lambda _: None) -> None:
        """on_message is called, in the thread, with each message of the client before it is passed on."""
        self.said: list[Any] = []
        self._on_message = on_message
        self._boat_port = boat_port
        self._parser = dialect.MAVLink(None)
        self._parser.robust_parsing = True
        self._server = socket.create_server(("127.0.0.1", 0))
        self._server.settimeout(0.1)
        self.port = self._server.getsockname()[1]
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="wiretap")
        self._thread.start()

    @property
    def url(self) -> str:
        """What the client connects to."""
        return f"tcp:127.0.0.1:{self.port}"

    def kinds(self) -> list[str]:
        """The types of what the client has said, in order."""
        return [message.get_type() for message in self.said]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._is_over.set()
        self._thread.join(5.0)
        self._server.close()
        assert not self._thread.is_alive()

    def _run(self) -> None:
        while not self._is_over.is_set():
            with contextlib.suppress(TimeoutError):
                client, _ = self._server.accept()
                with client, socket.create_connection(("127.0.0.1", self._boat_port)) as boat:
                    self._pass(client, boat)
                return

    def _pass(self, client: socket.socket, boat: socket.socket) -> None:
        with selectors.DefaultSelector() as selector, contextlib.suppress(OSError):
            selector.register(client, selectors.EVENT_READ, boat)
            selector.register(boat, selectors.EVENT_READ, client)
            while not self._is_over.is_set():
                for key, _ in selector.select(0.1):
                    source: socket.socket = key.fileobj  # type: ignore[assignment]
                    data = source.recv(65536)
                    if not data:
                        return
                    if source is client:
                        self._listen(data)
                    key.data.sendall(data)

    def _listen(self, data: bytes) -> None:
        for message in self._parser.parse_buffer(data) or []:
            self.said.append(message)
            self._on_message(message)
