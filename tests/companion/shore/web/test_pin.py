"""The PIN: its file, and how often it may be tried."""

import asyncio
import stat
from pathlib import Path

import pytest

from companion.core.errors import ConfigError, StorageError
from companion.shore.web.pin_file import PinFile, hashed, is_pin
from companion.shore.web.session import LIFE_S, Opened, Refused, Sessions
from companion.shore.web.throttle import Throttle, network_of

PIN = "482913"


def sessions(folder: Path) -> Sessions:
    pin = PinFile(folder / "pin")
    pin.write(PIN)
    return Sessions(pin)


def opened(of: Sessions, pin: str, address: str, now_s: float) -> Opened | Refused:
    return asyncio.run(of.open(pin, address, now_s))


def test_the_file_is_for_its_owner_and_holds_no_pin(tmp_path: Path) -> None:
    pin = PinFile(tmp_path / "new" / "pin")
    pin.write(PIN)
    assert stat.S_IMODE(pin.path.stat().st_mode) == 0o600
    assert PIN not in pin.path.read_text(encoding="ascii")
    line = pin.line()
    assert line is not None
    assert is_pin(PIN, line)
    assert not is_pin("482914", line)


def test_the_same_pin_is_hashed_differently_every_time() -> None:
    assert hashed(PIN) != hashed(PIN)


@pytest.mark.parametrize("pin", ["", "12345", "000000", "1" * 65, "1234\n5678", "123456\x00"])
def test_a_simple_or_strange_pin_is_refused(tmp_path: Path, pin: str) -> None:
    with pytest.raises(ConfigError, match="expected a PIN"):
        PinFile(tmp_path / "pin").write(pin)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_others_may_read_is_not_used(tmp_path: Path) -> None:
    pin = PinFile(tmp_path / "pin")
    pin.write(PIN)
    pin.path.chmod(0o640)
    with pytest.raises(StorageError, match="chmod 600"):
        pin.line()
    assert isinstance(opened(Sessions(pin), PIN, "10.0.0.1", 0.0), Refused)


@pytest.mark.parametrize(
    "text", ["", "scrypt", "scrypt 16384 8 1 zz zz", "scrypt 1 1 1 " + "0" * 32 + " " + "0" * 64]
)
def test_a_damaged_file_opens_nothing(tmp_path: Path, text: str) -> None:
    path = tmp_path / "pin"
    path.write_text(text, encoding="ascii")
    path.chmod(0o600)
    with pytest.raises(StorageError, match="damaged"):
        PinFile(path).line()


def test_a_session_ends_after_its_time_and_by_a_new_pin(tmp_path: Path) -> None:
    all_of_them = sessions(tmp_path)
    one = opened(all_of_them, PIN, "10.0.0.1", 0.0)
    assert isinstance(one, Opened)
    assert all_of_them.role(one.token, LIFE_S - 1.0) == "skipper"
    assert all_of_them.role(one.token, LIFE_S) == "viewer"
    PinFile(tmp_path / "pin").write("another PIN")
    assert all_of_them.role(one.token, 1.0) == "viewer"


@pytest.mark.parametrize("token", [None, "", "x", "\udc80", "a" * 10_000])
def test_a_made_up_cookie_is_a_viewers(tmp_path: Path, token: str | None) -> None:
    assert sessions(tmp_path).role(token, 0.0) == "viewer"


def test_a_flood_from_one_address_gets_a_dozen_tries_an_hour(tmp_path: Path) -> None:
    throttle = Throttle()
    tries = 0
    for second in range(3600):
        if throttle.wait_s("10.0.0.1", float(second)) == 0.0:
            throttle.begin("10.0.0.1", float(second))
            tries += 1
    assert 3 <= tries <= 16


def test_a_flood_from_many_addresses_is_held_up_in_total() -> None:
    throttle = Throttle()
    tries = 0
    for second in range(3600):
        address = f"10.{second // 65536}.{second // 256 % 256}.{second % 256}"
        if throttle.wait_s(address, float(second)) == 0.0:
            throttle.begin(address, float(second))
            tries += 1
    assert tries <= 10 + 5 + 3600 / 30


def test_who_has_told_the_pin_is_not_held_up_by_others() -> None:
    throttle = Throttle()
    throttle.begin("10.0.0.9", 0.0)
    throttle.succeed("10.0.0.9")
    for number in range(200):
        throttle.begin(f"10.0.1.{number}", 1.0)
    assert throttle.wait_s("10.0.2.1", 1.0) > 0.0
    assert throttle.wait_s("10.0.0.9", 1.0) == 0.0


def test_tries_at_the_same_moment_count_each_other(tmp_path: Path) -> None:
    async def test() -> None:
        all_of_them = sessions(tmp_path)
        told = await asyncio.gather(*(all_of_them.open(f"00000{n}", "10.0.0.1", 0.0) for n in range(9)))
        assert sum(isinstance(one, Refused) and one.is_held_up for one in told) == 6

    asyncio.run(test())


def test_one_computer_has_one_network() -> None:
    assert network_of("2001:db8::1") == network_of("2001:db8::ffff")
    assert network_of("2001:db8::1") != network_of("2001:db8:0:1::1")
    assert network_of("::ffff:10.0.0.1") == "10.0.0.1"
    assert network_of("fe80::1%wlan0") == network_of("fe80::2")
