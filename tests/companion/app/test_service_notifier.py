"""Messages to the service manager, read by a socket of the kind that systemd listens on."""

import contextlib
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from companion.app.process import ServiceNotifier
from companion.app.status_file import find_status
from companion.config.boat_config import BoatConfig
from companion.config.boat_config import StorageSetting as Storage
from companion.core.errors import ConfigError


class Manager:
    """The receiving end. environment: what it gives its service."""

    def __init__(self, address: str) -> None:
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(address.replace("@", "\0", 1))
        self.socket.setblocking(False)
        self.environment = {"NOTIFY_SOCKET": address}

    def received(self) -> list[list[str]]:
        """The lines of each datagram since the last call."""
        datagrams = []
        while True:
            try:
                datagrams.append(self.socket.recv(4096).decode().splitlines())
            except BlockingIOError:
                return datagrams


@pytest.fixture(params=["path", "abstract"])
def manager(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Manager]:
    name = str(tmp_path / "notify")
    manager = Manager(name if request.param == "path" else f"@{name}")
    yield manager
    manager.socket.close()


def fill(manager: Manager) -> None:
    """Send until not even a sender of its own gets one datagram through."""
    sent = 1
    while sent:
        sent = 0
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender, contextlib.suppress(BlockingIOError):
            sender.setblocking(False)
            while True:
                sender.sendto(b"X=1", manager.socket.getsockname())
                sent += 1


def run(notifier: ServiceNotifier, begin_s: float, end_s: float, status: str = "HOLD, disarmed") -> None:
    """Ticks of 20 ms in this time."""
    for number in range(round((end_s - begin_s) * 50)):
        notifier.tick(begin_s + number / 50, status)


def test_the_first_tick_reports_readiness_and_only_a_change_of_status_follows(manager: Manager) -> None:
    notifier = ServiceNotifier(manager.environment)
    assert manager.received() == []
    run(notifier, 0.0, 5.0)
    assert manager.received() == [["READY=1", "STATUS=HOLD, disarmed"]]
    notifier.tick(5.0, "AUTO, armed")
    notifier.stopping()
    notifier.close()
    notifier.close()
    assert manager.received() == [["STATUS=AUTO, armed"], ["STOPPING=1"]]


def test_the_watchdog_hears_from_the_loop_at_half_its_time(manager: Manager) -> None:
    notifier = ServiceNotifier({**manager.environment, "WATCHDOG_USEC": "2000000"})
    run(notifier, 100.0, 110.0)
    first, *others = manager.received()
    assert first == ["READY=1", "WATCHDOG_USEC=2000000", "STATUS=HOLD, disarmed", "WATCHDOG=1"]
    assert others == [["WATCHDOG=1"]] * 9
    notifier.close()


def test_a_restart_in_place_is_no_end_and_has_longer_than_the_watchdog(manager: Manager) -> None:
    environment = {**manager.environment, "WATCHDOG_USEC": "2000000"}
    notifier = ServiceNotifier(environment)
    notifier.tick(0.0, "HOLD, disarmed")
    manager.received()
    notifier.restarting()
    notifier.close()
    assert manager.received() == [["RELOADING=1", "WATCHDOG_USEC=30000000", "WATCHDOG=1"]]
    fresh = ServiceNotifier(environment)
    fresh.tick(0.0, "HOLD, disarmed")
    fresh.close()
    assert manager.received()[0][:2] == ["READY=1", "WATCHDOG_USEC=2000000"]


def test_a_full_queue_delays_a_message_and_no_tick(manager: Manager) -> None:
    fill(manager)
    notifier = ServiceNotifier(manager.environment)
    notifier.tick(0.0, "HOLD, disarmed")
    assert ["READY=1", "STATUS=HOLD, disarmed"] not in manager.received()
    notifier.tick(0.02, "HOLD, disarmed")
    assert manager.received() == [["READY=1", "STATUS=HOLD, disarmed"]]
    notifier.close()


@pytest.mark.parametrize("address", ["", "relative", "vsock:2:1234"])
def test_outside_a_unit_no_socket_is_opened(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*arguments: object) -> None:
        raise AssertionError("a socket was opened")

    monkeypatch.setattr(socket, "socket", refuse)
    notifier = ServiceNotifier({"NOTIFY_SOCKET": address} if address else {})
    run(notifier, 0.0, 1.0)
    notifier.restarting()
    notifier.stopping()
    notifier.close()


# Where the status file lies


def test_a_reader_outside_the_unit_finds_the_units_file_first(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv("RUNTIME_DIRECTORY", raising=False)
    config = BoatConfig(storage=Storage(folder="/var/lib/boat"))
    assert find_status(config, tmp_path) == Path("/var/lib/boat/status.json")
    with pytest.raises(ConfigError, match="keeps no status"):
        find_status(BoatConfig(), tmp_path)
    (tmp_path / "status.json").touch()
    assert find_status(config, tmp_path) == tmp_path / "status.json"
    assert find_status(BoatConfig(), tmp_path) == tmp_path / "status.json"
