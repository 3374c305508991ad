"""What the doctor says of the computer, from the files that a Raspberry Pi has."""

import os
from pathlib import Path
from types import SimpleNamespace

import pytest
from doctor_tree import Examine

from companion.app.doctor.computer import (
    check_disk,
    check_network,
    check_open_links,
    check_routes,
    check_supply,
)
from companion.app.doctor.findings import Verdict
from companion.config.boat_config import BoatConfig, LinkConfig, StorageSetting

pytest_plugins = ("doctor_fixtures",)

THROTTLED = "/sys/devices/platform/soc/soc:firmware/get_throttled"


@pytest.mark.parametrize(
    ("flags", "verdict", "text"),
    [
        ("0", Verdict.FINE, "no under-voltage and no throttling since the start"),
        ("1", Verdict.FAILED, "now: under-voltage"),
        ("50005", Verdict.FAILED, "now: under-voltage, throttled"),
        ("e0008", Verdict.WARNING, "now: soft temperature limit"),
        ("a0000", Verdict.WARNING, "since the start: frequency capped, soft temperature limit"),
    ],
)
def test_the_firmwares_flags_in_words(examine: Examine, flags: str, verdict: Verdict, text: str) -> None:
    found = check_supply(examine({THROTTLED: f"{flags}\n"}))
    assert (found.verdict, found.text) == (verdict, text)


@pytest.mark.parametrize(
    ("free_mb", "flags", "verdict"),
    [(201, 0, Verdict.FINE), (199, 0, Verdict.WARNING), (201, os.ST_RDONLY, Verdict.FAILED)],
)
def test_the_disk_of_missions_and_logs(
    examine: Examine, monkeypatch: pytest.MonkeyPatch, free_mb: int, flags: int, verdict: Verdict
) -> None:
    asked: list[Path] = []

    def statvfs(path: Path) -> SimpleNamespace:
        asked.append(path)
        return SimpleNamespace(f_bavail=free_mb * 1000, f_frsize=1000, f_flag=flags)

    examined = examine({"/var/lib/x": ""}, BoatConfig(storage=StorageSetting(folder="/var/lib/mavboat")))
    monkeypatch.setattr(os, "statvfs", statvfs)
    assert check_disk(examined).verdict is verdict
    assert asked == [examined.path("/var/lib")], "the folder is made at the first start"


# two networks of a boat with an access point and a home network, as Linux shows them
ROUTES = """Iface	Destination	Gateway 	Flags	RefCnt	Use	Metric	Mask		MTU	Window	IRTT
wlan1	00000000	0102A8C0	0003	0	0	600	00000000	0	0	0
wlan0	0004A8C0	00000000	0001	0	0	600	00FFFFFF	0	0	0
wlan1	0002A8C0	00000000	0001	0	0	600	00FFFFFF	0	0	0
"""


@pytest.mark.parametrize(
    ("url", "is_in_reach"),
    [
        ("udpout:192.168.4.255:14550", True),
        ("udpout:192.168.2.77:14550", True),
        ("udpout:192.168.5.255:14550", False),  # a broadcast does not pass the router
        ("udpout:203.0.113.9:14550", True),
        ("tcpout:203.0.113.9:5760", True),
        ("tcpin:0.0.0.0:5760", True),
        ("udpout:station.local:14550", True),
        ("serial:/dev/ttyUSB0:57600", True),
    ],
)
def test_an_address_that_no_network_of_the_boat_has_is_told(
    examine: Examine, url: str, is_in_reach: bool
) -> None:
    found = check_routes(examine({"/proc/net/route": ROUTES}, BoatConfig(links=(url,))))
    assert (found == []) is is_in_reach
    assert all(one.verdict is Verdict.WARNING and url in one.text for one in found)


def test_at_least_one_way_to_a_station_is_up(examine: Examine) -> None:
    down = {"/sys/class/net/lo/operstate": "unknown\n", "/sys/class/net/wlan0/operstate": "down\n"}
    assert check_network(examine(down)).verdict is Verdict.FAILED
    radio = BoatConfig(links=("serial:/dev/ttyUSB0:57600",))
    assert check_network(examine(down, radio)).verdict is Verdict.FINE
    up = check_network(examine({**down, "/sys/class/net/wlan1/operstate": "up\n"}))
    assert (up.verdict, up.text) == (Verdict.FINE, "up: wlan1")


@pytest.mark.parametrize(
    ("link", "is_open"),
    [
        (LinkConfig(url="udpout:192.168.4.255:14550"), True),
        (LinkConfig(url="udpout:192.168.4.255:14550", signing="accept", key_file="k"), True),
        (LinkConfig(url="udpout:192.168.4.255:14550", signing="required", key_file="k"), False),
        (LinkConfig(url="tcpin:0.0.0.0:5760"), True),
        (LinkConfig(url="udpin:[::]:14550"), True),
        (LinkConfig(url="tcpin:127.0.0.1:5760"), False),
        (LinkConfig(url="udpin:localhost:14550"), False),
        (LinkConfig(url="tcpin:[::1]:5760"), False),
        (LinkConfig(url="tcpout:10.8.0.2:5760"), False),
        (LinkConfig(url="serial:/dev/ttyUSB0:57600"), True),
        (LinkConfig(url="serial:/dev/ttyACM0:115200", radio=False), False),
    ],
)
def test_a_link_on_which_anybody_commands_the_boat_is_told(
    examine: Examine, link: LinkConfig, is_open: bool
) -> None:
    found = check_open_links(examine({}, BoatConfig(links=(link,))))
    assert (found.verdict is Verdict.WARNING) is is_open
    assert (link.url in found.text) is is_open
