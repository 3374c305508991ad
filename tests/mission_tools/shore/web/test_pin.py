"""The PIN: its file, and how often it may be tried."""

import asyncio
import stat
from pathlib import Path

import pytest
from shore_server import FakeClock

from companion.core.errors import ConfigError, StorageError
from mission_tools.shore.web.connections.throttle import MOST_PACE_S, Throttle, network_of
from mission_tools.shore.web.login.pin_file import PinFile, hashed, is_pin
from mission_tools.shore.web.login.session import LIFE_S, MOST_WAITING, LoginRefused, Sessions

pytest_plugins = ("server_fixtures",)
pytestmark = pytest.mark.slow

PIN = "482913"


def sessions(folder: Path) -> Sessions:
    pin = PinFile(folder / "pin")
    pin.write(PIN)
    return Sessions(pin)


def opened(of: Sessions, pin: str, address: str, now_s: float) -> str | LoginRefused:
    return asyncio.run(of.open(pin, address, now_s))


def test_the_file_is_for_its_owner_and_holds_no_pin(tmp_path: Path) -> None:
    pin = PinFile(tmp_path / "new" / "pin")
    pin.write(PIN)
    assert stat.S_IMODE(pin.path.stat().st_mode) == 0o600
    assert PIN not in pin.path.read_text(encoding="ascii")
    line = pin.line()
    assert line is not None
    assert is_pin(PIN, line)
    assert hashed(PIN) != line
    assert not is_pin("482914", line)


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
    assert isinstance(opened(Sessions(pin), PIN, "10.0.0.1", 0.0), LoginRefused)


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
    assert isinstance(one, str)
    assert all_of_them.role(one, LIFE_S - 1.0) == "skipper"
    assert all_of_them.role(one, LIFE_S) == "viewer"
    PinFile(tmp_path / "pin").write("another PIN")
    assert all_of_them.role(one, 1.0) == "viewer"


def test_a_made_up_cookie_is_a_viewers(tmp_path: Path) -> None:
    of = sessions(tmp_path)
    assert {of.role(token, 0.0) for token in (None, "", "x", "\udc80", "a" * 10_000)} == {"viewer"}


def tries_within(seconds: int, addresses: int) -> int:
    """How many PINs a network of these addresses has looked at, each as often as it may."""
    throttle, tries, next_s = Throttle(), 0, 0.0
    for second in range(seconds):
        for number in range(addresses):
            address = f"10.0.0.{number}"
            if second >= next_s and throttle.wait_s(address, float(second)) == 0.0:
                throttle.begin(address, float(second))
                throttle.fail(float(second))
                next_s = second + throttle.pace_s(float(second))
                tries += 1
    return tries


def test_a_flood_from_one_address_gets_a_dozen_tries_an_hour() -> None:
    assert 3 <= tries_within(3600, 1) <= 16


def test_a_whole_network_gets_no_more_than_one_try_a_second() -> None:
    assert tries_within(900, 254) <= 900 + 40


class Attack:
    """Sixty addresses, each of which tries a wrong PIN as soon as it may."""

    def __init__(self, victim: Sessions) -> None:
        self.victim = victim
        self.now_s = 0.0
        self.tries: list[asyncio.Task[str | LoginRefused]] = []

    async def go_on(self) -> None:
        """A quarter of a second."""
        self.now_s += 0.25
        for number in range(60):
            told = self.victim.open("000001", f"10.0.1.{number}", self.now_s)
            self.tries.append(asyncio.create_task(told))
        await asyncio.sleep(0)
        self.victim.poll(self.now_s)
        while self.victim._check is not None:
            await self.victim._check
            await asyncio.sleep(0)
        self.tries = [one for one in self.tries if not one.done() or isinstance(one.result(), str)]

    async def phone_waits_s(self, address: str) -> float:
        """Until the right PIN opens a session."""
        began_s = self.now_s
        phone = asyncio.create_task(self.victim.open(PIN, address, self.now_s))
        while not phone.done():
            await self.go_on()
        assert isinstance(phone.result(), str)
        return self.now_s - began_s

    async def end(self) -> None:
        for one in self.tries:
            one.cancel()
        told = await asyncio.gather(*self.tries, return_exceptions=True)
        assert not any(isinstance(one, str) for one in told)


async def test_wrong_pins_from_many_addresses_keep_no_new_phone_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mission_tools.shore.web.login.session.is_pin", lambda pin, _line: pin == PIN)
    attack = Attack(sessions(tmp_path))
    await attack.go_on()
    first_s = await attack.phone_waits_s("10.0.9.1")
    assert first_s <= MOST_WAITING * MOST_PACE_S, "every other address has its first turn before"
    while attack.now_s < 120.0:
        await attack.go_on()
    assert await attack.phone_waits_s("10.0.9.2") <= 2.0 * MOST_PACE_S
    await attack.end()


async def test_the_tries_that_wait_are_bounded_and_the_latest_gives_way(tmp_path: Path) -> None:
    all_of_them = sessions(tmp_path)
    told = [
        asyncio.create_task(all_of_them.open("000001", f"10.0.{n // 250}.{n % 250}", 0.0))
        for n in range(MOST_WAITING + 20)
    ]
    await asyncio.sleep(0)
    refused = [one for one in told if one.done()]
    assert len(refused) >= 19
    assert all(isinstance(one.result(), LoginRefused) for one in refused)
    for one in told:
        one.cancel()
    await asyncio.gather(*told, return_exceptions=True)
    assert all_of_them._waiting == []


async def test_tries_at_the_same_moment_count_each_other(tmp_path: Path) -> None:
    all_of_them = sessions(tmp_path)
    told = await asyncio.gather(*(all_of_them.open(f"00000{n}", "10.0.0.1", 0.0) for n in range(9)))
    assert sum(isinstance(one, LoginRefused) and one.is_held_up for one in told) == 6


def restarted(folder: Path, at_s: float) -> Sessions:
    """The program begins anew: its clock at 0, the date goes on."""
    return Sessions(PinFile(folder / "pin"), FakeClock(0.0, 1.8e9 + at_s))


def test_a_session_outlasts_a_restart_and_keeps_its_end(tmp_path: Path) -> None:
    PinFile(tmp_path / "pin").write(PIN)
    before = restarted(tmp_path, 0.0)
    one = opened(before, PIN, "10.0.0.1", 0.0)
    assert isinstance(one, str)
    after = restarted(tmp_path, 3600.0)
    assert after.role(one, 0.0) == "skipper"
    assert after.is_known("10.0.0.1"), "its address is a skipper's to the limits, too"
    assert after.role(one, LIFE_S - 3601.0) == "skipper"
    assert after.role(one, LIFE_S - 3599.0) == "viewer"
    backwards = restarted(tmp_path, -1e8)
    assert backwards.role(one, LIFE_S + 1.0) == "viewer", "a date that goes back prolongs nothing"


def test_a_session_that_was_locked_or_whose_pin_was_changed_does_not_come_back(tmp_path: Path) -> None:
    PinFile(tmp_path / "pin").write(PIN)
    before = restarted(tmp_path, 0.0)
    one, other = opened(before, PIN, "10.0.0.1", 0.0), opened(before, PIN, "10.0.0.2", 0.0)
    assert isinstance(one, str)
    assert isinstance(other, str)
    before.close(one)
    after = restarted(tmp_path, 1.0)
    assert (after.role(one, 0.0), after.role(other, 0.0)) == ("viewer", "skipper")
    PinFile(tmp_path / "pin").write("another PIN")
    assert restarted(tmp_path, 1.0).role(other, 0.0) == "viewer"


def test_the_file_of_sessions_is_for_its_owner_and_holds_no_token(tmp_path: Path) -> None:
    PinFile(tmp_path / "pin").write(PIN)
    one = opened(restarted(tmp_path, 0.0), PIN, "10.0.0.1", 0.0)
    assert isinstance(one, str)
    file = tmp_path / "pin-sessions"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert one not in file.read_text("utf-8")
    file.chmod(0o644)
    assert restarted(tmp_path, 1.0).role(one, 0.0) == "viewer"


@pytest.mark.parametrize("content", [b"", b"[", b"{}", b'[{"key": 1}]', b"\xff", b"[" * 100_000])
def test_a_damaged_file_of_sessions_holds_none(tmp_path: Path, content: bytes) -> None:
    PinFile(tmp_path / "pin").write(PIN)
    file = tmp_path / "pin-sessions"
    file.write_bytes(content)
    file.chmod(0o600)
    assert restarted(tmp_path, 0.0).has_pin


def test_one_computer_has_one_network() -> None:
    assert network_of("2001:db8::1") == network_of("2001:db8::ffff")
    assert network_of("2001:db8::1") != network_of("2001:db8:0:1::1")
    assert network_of("::ffff:10.0.0.1") == "10.0.0.1"
    assert network_of("fe80::1%wlan0") == network_of("fe80::2")
