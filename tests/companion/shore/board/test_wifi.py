"""Changes of the Wi-Fi: kept only if the page is heard afterwards."""

import asyncio
import json
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

import msgspec
import pytest
from twins.wifi_air import Air

from companion.shore.board.nmcli import Nmcli
from companion.shore.board.wifi import HOTSPOT, Wifi, WifiRefusedError, hashed

HOSTILE = "a'; x; $(id) `id` \\\" #:-"
PASSWORD = "pa$$ w'o\"r`d\\;#"  # noqa: S105
LATER = 60.0  # nobody waits for it


@pytest.fixture
def air(tmp_path: Path) -> Air:
    """A boat in its owner's network."""
    air = Air(tmp_path / "air")
    air.add("home")
    air.know("home", is_active=True)
    return air


def run(test: Coroutine[Any, Any, None]) -> None:
    asyncio.run(test)


async def until(wifi: Wifi, *stages: str) -> None:
    """The test's own time limit ends what never is."""
    while wifi.change.stage not in stages:
        await asyncio.sleep(0.01)


def wifi_of(air: Air, confirm_s: float = LATER) -> Wifi:
    return Wifi(Nmcli(str(air.nmcli)), confirm_s)


@pytest.mark.parametrize("security", ["WPA2", "WPA3"])
def test_a_network_is_kept_once_the_page_asks_again(air: Air, security: str) -> None:
    air.add(HOSTILE, PASSWORD, security=security)
    old = air.know(HOSTILE, psk="of an earlier password", kind="wpa-psk")

    async def test() -> None:
        wifi = wifi_of(air)
        wifi.join(HOSTILE, security, PASSWORD)
        await until(wifi, "unconfirmed")
        assert air.active() == [HOSTILE]
        assert [one["autoconnect"] for one in air.known() if one["ssid"] == HOSTILE] == ["yes", "no"]
        assert (await wifi.state()).address == "10.0.0.7"
        await until(wifi, "kept")
        (now,) = [one for one in air.known() if one["ssid"] == HOSTILE]
        assert now["uuid"] != old
        assert (now["active"], now["autoconnect"]) == (True, "yes")

    run(test())
    for call in air.calls():
        assert PASSWORD not in " ".join(call)
        assert hashed(PASSWORD, HOSTILE) not in call


def test_a_wrong_password_brings_the_boat_back(air: Air) -> None:
    air.add("cafe", PASSWORD)

    async def test() -> None:
        wifi = wifi_of(air)
        wifi.join("cafe", "WPA2", "not the password")
        await until(wifi, "failed")
        assert "Secrets were required" in wifi.change.why["text"]
        assert air.active() == ["home"]
        assert [one["ssid"] for one in air.known()] == ["home"]

    run(test())


def test_a_network_in_which_nobody_opens_the_page_is_left_again(air: Air) -> None:
    air.add("cafe", PASSWORD)

    async def test() -> None:
        wifi = wifi_of(air, confirm_s=0.05)
        wifi.join("cafe", "WPA2", PASSWORD)
        await until(wifi, "back")
        assert air.active() == ["home"]
        assert [one["ssid"] for one in air.known()] == ["home"]

    run(test())


def test_a_page_that_asks_while_the_boat_still_changes_confirms_nothing(air: Air) -> None:
    air.add("cafe", PASSWORD)

    async def test() -> None:
        wifi = wifi_of(air, confirm_s=0.3)
        wifi.join("cafe", "WPA2", PASSWORD)
        await wifi.state()
        await until(wifi, "back")

    run(test())


def test_the_boats_own_network_has_its_password_and_is_used_again_without(air: Air) -> None:
    async def test() -> None:
        wifi = wifi_of(air)
        wifi.start_hotspot("")
        await until(wifi, "failed")
        assert wifi.change.why["key"] == "board.wifi.first_password"
        assert json.loads(msgspec.json.encode(await wifi.state()))["change"]["stage"] == "failed"
        wifi.start_hotspot(PASSWORD)
        await until(wifi, "unconfirmed")
        state = await wifi.state()
        assert (state.is_hotspot, state.has_hotspot, state.address) == (True, True, "192.168.4.1")
        await until(wifi, "kept")
        (own,) = [one for one in air.known() if one["name"] == HOTSPOT]
        assert own["psk"] == hashed(PASSWORD, "mavboat")
        wifi.stop_hotspot()
        await until(wifi, "unconfirmed")
        assert air.active() == ["home"]
        await wifi.state()
        await until(wifi, "kept")
        wifi.start_hotspot("")
        await until(wifi, "unconfirmed")
        assert air.active() == ["mavboat"]
        await wifi.close()

    run(test())


def test_the_boats_own_network_stays_where_no_other_is_known(air: Air) -> None:
    air.networks.clear()
    air.write()

    async def test() -> None:
        wifi = wifi_of(air)
        wifi.start_hotspot(PASSWORD)
        await until(wifi, "unconfirmed")
        await wifi.state()
        await until(wifi, "kept")
        wifi.stop_hotspot()
        await until(wifi, "failed")
        assert air.active() == ["mavboat"]

    run(test())


def test_known_networks_are_used_and_forgotten_but_not_the_one_in_use(air: Air) -> None:
    air.add("lake")
    lake = air.know("lake")

    async def test() -> None:
        wifi = wifi_of(air)
        await wifi.use(lake)
        await until(wifi, "unconfirmed")
        with pytest.raises(WifiRefusedError, match="in use"):
            await wifi.forget(lake)
        await wifi.state()
        await until(wifi, "kept")
        await wifi.forget("00000000-0000-0000-0000-000000000000")
        assert [one["ssid"] for one in air.known()] == ["lake"]
        with pytest.raises(WifiRefusedError, match="no such network"):
            await wifi.forget("--help")
        with pytest.raises(WifiRefusedError, match="no such network"):
            await wifi.use("00000000-0000-0000-0000-000000000000")

    run(test())


@pytest.mark.parametrize(
    ("name", "security", "password"),
    [
        ("", "open", ""),
        ("x" * 33, "open", ""),
        ("é" * 17, "open", ""),
        ("a\nb", "open", ""),
        ("\ud800", "open", ""),
        ("cafe", "other", PASSWORD),
        ("cafe", "WEP", PASSWORD),
        ("cafe", "WPA2", "seven 7"),
        ("cafe", "WPA2", "x" * 64),
        ("cafe", "WPA3", "line\nquit\nend"),
        ("cafe", "WPA3", " at its end "),
        ("cafe", "WPA2", "pässwörter"),
    ],
)
def test_what_cannot_be_joined_is_refused_before_nmcli_is_asked(
    air: Air, name: str, security: str, password: str
) -> None:
    async def test() -> None:
        wifi = wifi_of(air)
        with pytest.raises(WifiRefusedError):
            wifi.join(name, security, password)
        assert wifi.change.stage == "idle"

    run(test())
    assert not (air.folder / "calls").exists()


def test_one_change_at_a_time(air: Air) -> None:
    air.add("cafe", PASSWORD)

    async def test() -> None:
        wifi = wifi_of(air)
        wifi.join("cafe", "WPA2", PASSWORD)
        with pytest.raises(WifiRefusedError, match="changing already"):
            wifi.start_hotspot(PASSWORD)
        await wifi.close()

    run(test())


def test_the_key_of_a_password_is_that_of_the_standard() -> None:
    """IEEE 802.11-2020, annex J.4.2, test vectors."""
    assert hashed("password", "IEEE") == "f42c6fc52df0ebef9ebb4b90b38a5f902e83fe1b135a70e23aed762e9710a12e"
    assert (
        hashed("ThisIsAPassword", "ThisIsASSID")
        == "0dc0d6eb90555ed6419756b9a15ec3e3209b63df707dd508d14581f8982721af"
    )
