"""The shore page installed into a Debian system and started by that system's own systemd."""

import json
import random
import socket
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from systemd_machine import SystemdMachine, why_not
from test_installed_boat import BOAT, COMPANION, SCRIPTS, InstalledBoat, prepared, start_machine

REASON = why_not()
pytestmark = [pytest.mark.realtime, pytest.mark.skipif(bool(REASON), reason=REASON)]
__all__ = ("prepared", "start_machine")

PAGE = "mavboat-shore.service"
PIN = "482913"
# ports of their own: this machine's network is shared; for the page's it needs its capability
DROP_IN = """
[Service]
ExecStart=
ExecStart={bin}/boat-shore --connect tcp:127.0.0.1:{tcp} --listen 127.0.0.1:{http} \
    --pin-file /var/lib/mavboat/shore-pin --boat /etc/mavboat/boat.toml
BindReadOnlyPaths={bound}
"""


def free_port(ports: range) -> int:
    """A TCP port that nobody uses."""
    for port in random.sample(ports, len(ports)):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            return port
    raise AssertionError("no port is free")


class Visitor:
    """A browser with the PIN."""

    def __init__(self, port: int) -> None:
        self.base = f"http://127.0.0.1:{port}"
        self._web = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())
        self.post("/api/session", {"pin": PIN})

    def get(self, path: str) -> Any:  # noqa: ANN401
        with self._web.open(self.base + path) as answer:
            return json.load(answer)

    def post(self, path: str, content: object) -> Any:  # noqa: ANN401
        headers = {"Origin": self.base, "Content-Type": "application/json"}
        asked = urllib.request.Request(self.base + path, json.dumps(content).encode(), headers)  # noqa: S310
        with self._web.open(asked) as answer:
            return json.load(answer)


def is_heard(visitor: Visitor) -> bool:
    """Whether the page hears the boat."""
    return bool(visitor.get("/api/boats"))


def test_the_installed_page_hears_the_boat_and_may_not_change_its_configuration(
    start_machine: Callable[[str], SystemdMachine], prepared: str, tmp_path: Path
) -> None:
    tcp, http = free_port(range(20_000, 30_000)), free_port(range(600, 1000))
    boat_toml = BOAT.replace("tcpin:127.0.0.1:0", f"tcpin:127.0.0.1:{tcp}")
    (tmp_path / "boat.toml").write_text(boat_toml, encoding="utf-8")
    bound = (tmp_path / "mock.conf").read_text("utf-8").partition("BindReadOnlyPaths=")[2].splitlines()[0]
    text = DROP_IN.format(bin=SCRIPTS, tcp=tcp, http=http, bound=bound)
    (tmp_path / "page.conf").write_text(text, encoding="utf-8")
    drop_in = f"$root/etc/systemd/system/{PAGE}.d"
    install = f"{COMPANION} install --root $root --config {tmp_path}/boat.toml --programs {SCRIPTS} --page"
    machine = start_machine(
        f"{prepared}\nmkdir {drop_in}; cp {tmp_path}/page.conf {drop_in}/\n{install}\n"
        f"echo {PIN} | {SCRIPTS}/boat-shore pin --pin-file $root/var/lib/mavboat/shore-pin\n"
        "chroot $root chown mavboat:mavboat /var/lib/mavboat/shore-pin"
    )
    InstalledBoat(machine).wait_until("ActiveState", "active")
    machine.until(lambda: "the page:" in machine.run("journalctl", "-o", "cat", "-u", PAGE), "page")
    process = f"/proc/{machine.show(PAGE, 'MainPID')['MainPID']}"
    assert machine.run("stat", "-c", "%U", process) == "mavboat\n"

    visitor = Visitor(http)
    machine.until(lambda: is_heard(visitor), "heard")
    user = ("runuser", "-u", "mavboat", "--", "sh", "-c")
    writable = "test -w /etc/mavboat -o -w /etc/mavboat/boat.toml; echo $?"
    assert machine.run(*user, writable) == "1\n"
    machine.run(*COMPANION.split(), "uninstall", check=True)
    assert machine.show(PAGE, "LoadState") == {"LoadState": "not-found"}
