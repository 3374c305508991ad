"""Messages to the service manager, as sd_notify(3) and sd_watchdog_enabled(3) describe them.

Outside a unit of Type=notify there is no NOTIFY_SOCKET, and nothing is sent. A message is one datagram of
`NAME=value` lines, which needs no library.
"""

import contextlib
import os
import socket
from collections.abc import Mapping
from typing import Final

from companion.core.vehicle_status import VehicleStatus

_USEC: Final = 1e6
RESTART_WATCHDOG_S: Final = (
    30.0  # while the program replaces itself: its imports take up to 10 s on a Pi Zero 2
)


class ServiceNotifier:
    """Reports readiness, the watchdog's keep-alive, one status line, and the end. No call blocks or raises.

    A message that the manager's full queue does not take is sent again at the next tick.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        address = environment.get("NOTIFY_SOCKET", "")
        self._address = (
            "\0" + address[1:] if address.startswith("@") else address
        )  # @: the abstract namespace
        self._watchdog_usec = _watchdog_usec(environment)
        self._socket: socket.socket | None = None
        self._is_ready = False
        self._status = ""
        self._due_s = 0.0
        if self._address.startswith(("/", "\0")):
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)
            self._socket.setblocking(False)

    @property
    def is_supervised(self) -> bool:
        """Whether a service manager has started the program."""
        return self._socket is not None

    def tick(self, now_s: float, status: str) -> None:
        """To be called at the end of every tick. status: one line, sent when it changes."""
        lines = []
        if not self._is_ready:
            lines.append("READY=1")
            if self._watchdog_usec:  # `restarting` may have changed it
                lines.append(f"WATCHDOG_USEC={self._watchdog_usec}")
        if status != self._status:
            lines.append(f"STATUS={status}")
        if self._watchdog_usec and now_s >= self._due_s:
            lines.append("WATCHDOG=1")
        if lines and self._send(lines):
            self._is_ready = True
            self._status = status
            self._due_s = now_s + self._watchdog_usec / 2.0 / _USEC  # as sd_watchdog_enabled(3) recommends

    def restarting(self) -> None:
        """The process is about to be replaced by a fresh start of the program."""
        lines = ["RELOADING=1"]
        if self._watchdog_usec:
            lines += [f"WATCHDOG_USEC={RESTART_WATCHDOG_S * _USEC:.0f}", "WATCHDOG=1"]
        if self._is_ready:
            self._send(lines)

    def stopping(self) -> None:
        """Tell the manager that the program ends."""
        self._send(["STOPPING=1"])

    def close(self) -> None:
        """Release the socket. May be called twice."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, lines: list[str]) -> bool:
        if self._socket is None:
            return True
        with contextlib.suppress(OSError):
            self._socket.sendto("\n".join(lines).encode(), self._address)
            return True
        return False


def status_line(status: VehicleStatus) -> str:
    """What `systemctl status` shows of the boat."""
    return f"{status.mode.name}, {'armed' if status.armed else 'disarmed'}"


def _watchdog_usec(environment: Mapping[str, str]) -> int:
    """0 without a watchdog, or with one for another process."""
    own, usec = str(os.getpid()), environment.get("WATCHDOG_USEC", "")
    is_for_us = environment.get("WATCHDOG_PID", own) == own
    return int(usec) if is_for_us and usec.isascii() and usec.isdigit() else 0
