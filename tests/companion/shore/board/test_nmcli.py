"""The terse output of nmcli, as 1.42.4 printed it."""

import asyncio
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.fake_nmcli import escaped
from twins.wifi_air import Air

from companion.shore.board.nmcli import Nmcli, NmcliError, split_row


@pytest.mark.parametrize(
    ("line", "fields"),
    [
        (
            r"my\: net\\x:5f1d4be7-1dd0-48e2-83b0-a0f168171769:802-11-wireless:no:",
            [r"my: net\x", "5f1d4be7-1dd0-48e2-83b0-a0f168171769", "802-11-wireless", "no", ""],
        ),
        ("lo:loopback:unmanaged:", ["lo", "loopback", "unmanaged", ""]),
        ("*:41:72:WPA1 WPA2", ["*", "41", "72", "WPA1 WPA2"]),
        ("", [""]),
    ],
)
def test_a_row_is_divided_at_its_colons(line: str, fields: list[str]) -> None:
    assert split_row(line)[: len(fields)] == fields


@given(st.lists(st.text(st.characters(exclude_characters="\n")), min_size=1))
def test_what_was_escaped_comes_back(fields: list[str]) -> None:
    assert split_row(":".join(escaped(one) for one in fields)) == fields


def test_networks_are_listed_once_the_one_in_use_first_then_by_signal(tmp_path: Path) -> None:
    air = Air(tmp_path / "air")
    air.add("far", "password", signal=20)
    air.add("near", signal=80)
    air.add("near", signal=90)
    air.add("home", "password", signal=10, security="WPA1 WPA2")
    air.add("new", "password", signal=50, security="WPA3")
    air.add("both", "password", signal=49, security="WPA2 WPA3")
    air.add("work", "password", signal=48, security="WPA2 802.1X")
    air.add("", signal=99)
    air.add("line\nend", signal=98)
    air.add("latin", signal=97, hex="FCFC")
    air.add("broken", signal=96, hex="4")
    air.know("home", is_active=True)
    found = asyncio.run(Nmcli(str(air.nmcli)).networks())
    assert [(one.name, one.signal, one.security, one.is_used) for one in found] == [
        ("home", 10, "WPA2", True),
        ("near", 90, "open", False),
        ("new", 50, "WPA3", False),
        ("both", 49, "WPA2", False),
        ("work", 48, "other", False),
        ("far", 20, "WPA2", False),
    ]


def test_five_hundred_networks_are_read(tmp_path: Path) -> None:
    air = Air(tmp_path / "air")
    air.networks = [
        {"name": f"net: {number}\\", "signal": number % 101, "security": "WPA2"} for number in range(500)
    ]
    air.write()
    found = asyncio.run(Nmcli(str(air.nmcli)).networks())
    assert {one.name for one in found} == {f"net: {number}\\" for number in range(500)}


def test_only_wifi_connections_are_known(tmp_path: Path) -> None:
    air = Air(tmp_path / "air")
    number = air.know("a:b\\c", is_active=True)
    (one,) = asyncio.run(Nmcli(str(air.nmcli)).saved())
    assert (one.uuid, one.name, one.is_active) == (number, "a:b\\c", True)


def test_what_it_refuses_is_told_in_its_first_line(tmp_path: Path) -> None:
    air = Air(tmp_path / "air")
    (air.folder / "broken").touch()
    with pytest.raises(NmcliError, match=r"^NetworkManager is not running\.$"):
        asyncio.run(Nmcli(str(air.nmcli)).networks())


def test_a_computer_without_it_says_so() -> None:
    with pytest.raises(NmcliError, match="nmcli cannot be started: No such file"):
        asyncio.run(Nmcli("/no/such/nmcli").networks())


def test_one_that_hangs_is_ended(tmp_path: Path) -> None:
    slow = tmp_path / "nmcli"
    slow.write_text("#!/bin/sh\nexec sleep 60\n", encoding="utf-8")
    slow.chmod(0o755)
    with pytest.raises(NmcliError, match=r"did not answer within 0\.1 s"):
        asyncio.run(Nmcli(str(slow)).ask("device", longest_s=0.1))
