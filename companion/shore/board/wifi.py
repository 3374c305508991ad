"""The boat's Wi-Fi: a change is kept only if the boat is then heard of again.

Theory of operation
-------------------
The connection in use is noted. The new one is made without `autoconnect` and activated. If that fails, or if
no page with the PIN asks anything within CONFIRM_S afterwards, the earlier one is activated again: a boat
that has left the only network in reach of its operator would be lost to the page. A restart of the computer
in between ends in an earlier connection, too. Only when the page was heard is `autoconnect` set.
"""

import asyncio
import contextlib
import hashlib
import logging
from collections.abc import Awaitable, Callable
from typing import Any, Final, Literal

from msgspec import Struct

from companion.shore.board.nmcli import WIFI, Link, Network, Nmcli, NmcliError, Saved
from companion.shore.words import Said, say

_log: Final = logging.getLogger(__name__)

HOTSPOT: Final = "mavboat-hotspot"  # the connection's name
HOTSPOT_NAME: Final = "mavboat"  # the network's
UP_S: Final = 45.0  # for radio, password and DHCP
CONFIRM_S: Final = 120.0  # for a phone to change its network and open the page again
LEAST_PASSWORD: Final = 8
MOST_PASSWORD: Final = 63
MOST_NAME_BYTES: Final = 32
_ROUNDS: Final = 4096  # IEEE 802.11, annex J.4.1: PBKDF2 of the passphrase, 256 bits
_HOTSPOT_SETTINGS: Final = (
    "con-name", HOTSPOT, "ssid", HOTSPOT_NAME, f"{WIFI}.mode", "ap", f"{WIFI}.band", "bg",
    "ipv4.method", "shared", "ipv4.addresses", "192.168.4.1/24", "ipv6.method", "disabled",
    f"{WIFI}-security.key-mgmt", "wpa-psk", f"{WIFI}-security.proto", "rsn",
    f"{WIFI}-security.pairwise", "ccmp",
    "connection.autoconnect", "no", "connection.autoconnect-priority", "-10",
)  # fmt: skip

Stage = Literal["idle", "changing", "unconfirmed", "kept", "failed", "back"]


class Change(Struct, frozen=True):
    """The latest change. name: of the network, empty for none. why: for the page's `told`."""

    stage: Stage = "idle"
    name: str = ""
    why: dict[str, Any] = {}
    confirm_s: float = CONFIRM_S


class WifiState(Struct, frozen=True):
    """What the page shows. device: empty without Wi-Fi. has_hotspot: a password for it is stored."""

    device: str
    address: str
    networks: list[Network]
    saved: list[Saved]
    has_hotspot: bool
    is_hotspot: bool
    change: Change


class WifiRefusedError(Exception):
    """Something that cannot be asked. Its one argument is the text for people."""


class Wifi:
    """One change at a time."""

    def __init__(self, nmcli: Nmcli | None = None, confirm_s: float = CONFIRM_S) -> None:
        self._nmcli = nmcli or Nmcli()
        self._confirm_s = confirm_s
        self._task: asyncio.Task[None] | None = None
        self._heard = asyncio.Event()
        self._asking = asyncio.Lock()
        self.change = Change()

    async def state(self) -> WifiState:
        """Networks, and what is connected. A page asks: the boat is in reach, so a change is kept.

        Raises:
            NmcliError: NetworkManager does not answer.
        """
        if self.change.stage == "unconfirmed":
            self._heard.set()
        async with self._asking:
            return await self._look()

    async def _look(self) -> WifiState:
        link = await self._link()
        saved = await self._nmcli.saved()
        is_ours = {one.uuid: one.name == HOTSPOT for one in saved}
        return WifiState(
            device=link.device,
            address=await self._nmcli.address(link.device) if link.uuid else "",
            networks=await self._nmcli.networks(),
            saved=saved,
            has_hotspot=any(is_ours.values()),
            is_hotspot=is_ours.get(link.uuid, False),
            change=self.change,
        )

    def join(self, name: str, security: str, password: str) -> None:
        """Begin to join a network.

        Raises:
            WifiRefusedError: says why not.
        """
        size = len(name.encode("utf-8", "replace"))
        if not 1 <= size <= MOST_NAME_BYTES or not name.isprintable():
            raise WifiRefusedError(say("board.wifi.bad_name", most=MOST_NAME_BYTES))
        settings = ["con-name", name, "ssid", name, "connection.autoconnect", "no"]
        secret = ""
        if security not in ("open", "WPA2", "WPA3"):
            raise WifiRefusedError(say("board.wifi.other"))
        if security != "open":
            _check_password(password)
            kind = "sae" if security == "WPA3" else "wpa-psk"
            settings += [f"{WIFI}-security.key-mgmt", kind]
            secret = password if security == "WPA3" else hashed(password, name)

        async def prepare() -> str:
            return await self._nmcli.add(*settings, secret=secret)

        self._begin(name, prepare, is_new=True)

    def start_hotspot(self, password: str) -> None:
        """Begin to offer the boat's own network. password: empty: the one that is stored.

        Raises:
            WifiRefusedError: says why not.
        """
        if password:
            _check_password(password)

        async def prepare() -> str:
            stored = [one.uuid for one in await self._nmcli.saved() if one.name == HOTSPOT]
            if stored and not password:
                return stored[0]
            if not password:
                raise NmcliError(say("board.wifi.first_password"))
            uuid = await self._nmcli.add(*_HOTSPOT_SETTINGS, secret=hashed(password, HOTSPOT_NAME))
            for one in stored:
                await self._nmcli.ask("connection", "delete", "uuid", one)
            return uuid

        self._begin(HOTSPOT_NAME, prepare, is_new=False)

    def stop_hotspot(self) -> None:
        """Begin to use the strongest network that is known instead of the boat's own.

        Raises:
            WifiRefusedError: another change is under way.
        """

        async def prepare() -> str:
            known = {one.name: one.uuid for one in await self._nmcli.saved() if one.name != HOTSPOT}
            for one in await self._nmcli.networks():
                if one.name in known:
                    return known[one.name]
            raise NmcliError(say("board.wifi.no_other"))

        self._begin("", prepare, is_new=False)

    async def use(self, uuid: str) -> None:
        """Begin to use a stored connection.

        Raises:
            WifiRefusedError: there is none, or another change is under way.
            NmcliError: NetworkManager does not answer.
        """
        one = next((one for one in await self._nmcli.saved() if one.uuid == uuid), None)
        if one is None:
            raise WifiRefusedError(say("board.wifi.unknown"))

        async def prepare() -> str:
            return uuid

        self._begin(HOTSPOT_NAME if one.name == HOTSPOT else one.name, prepare, is_new=False)

    async def forget(self, uuid: str) -> None:
        """Delete a stored connection that is not in use.

        Raises:
            WifiRefusedError: it is in use, or there is none.
            NmcliError: NetworkManager refuses.
        """
        one = next((one for one in await self._nmcli.saved() if one.uuid == uuid), None)
        if one is None:
            raise WifiRefusedError(say("board.wifi.unknown"))
        if one.is_active or self._is_busy:
            raise WifiRefusedError(say("board.wifi.in_use"))
        await self._nmcli.ask("connection", "delete", "uuid", uuid)

    async def close(self) -> None:
        """End what is under way; NetworkManager goes on by itself."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    @property
    def _is_busy(self) -> bool:
        return self._task is not None and not self._task.done()

    async def _link(self) -> Link:
        found = [link for link in await self._nmcli.links() if link.kind == "wifi"]
        return found[0] if found else Link("", "", "", "")

    def _begin(self, name: str, prepare: Callable[[], Awaitable[str]], *, is_new: bool) -> None:
        if self._is_busy:
            raise WifiRefusedError(say("board.wifi.busy"))
        self.change = Change("changing", name, confirm_s=self._confirm_s)
        self._heard.clear()
        self._task = asyncio.create_task(self._do(name, prepare, is_new=is_new))

    async def _do(self, name: str, prepare: Callable[[], Awaitable[str]], *, is_new: bool) -> None:
        stage: Stage
        try:
            stage, text = await self._switch(name, prepare, is_new=is_new)
        except NmcliError as error:
            stage, text = "failed", error.args[0]
        except Exception:
            _log.exception("the change of the Wi-Fi has failed")
            stage, text = "failed", say("board.wifi.refused")
        self.change = Change(stage, name, text.to_page() if isinstance(text, Said) else {"text": text})

    async def _switch(
        self, name: str, prepare: Callable[[], Awaitable[str]], *, is_new: bool
    ) -> tuple[Stage, str]:
        nmcli, earlier = self._nmcli, (await self._link()).uuid
        uuid = await prepare()
        stage: Stage = "back"
        text = ""
        try:
            await nmcli.up(uuid, UP_S)
            self.change = Change("unconfirmed", name, confirm_s=self._confirm_s)
            async with asyncio.timeout(self._confirm_s):
                await self._heard.wait()
            await nmcli.ask("connection", "modify", "uuid", uuid, "connection.autoconnect", "yes")
        except NmcliError as error:
            stage, text = "failed", error.args[0]
        except TimeoutError:
            pass
        else:
            if is_new:
                await self._delete_twins(uuid, name)
            return "kept", ""
        with contextlib.suppress(NmcliError):  # it is not active, since it failed
            await nmcli.ask("connection", "delete" if is_new else "down", "uuid", uuid)
        if earlier and earlier != uuid:
            await nmcli.up(earlier, UP_S)
        return stage, text

    async def _delete_twins(self, uuid: str, name: str) -> None:
        """Earlier connections to the same network, whose password may be another."""
        for one in await self._nmcli.saved():
            if one.name == name and one.uuid != uuid:
                await self._nmcli.ask("connection", "delete", "uuid", one.uuid)


def hashed(password: str, name: str) -> str:
    """The key of WPA2 that a password stands for, 64 hexadecimal digits: what NetworkManager stores."""
    return hashlib.pbkdf2_hmac("sha1", password.encode(), name.encode(), _ROUNDS, 32).hex()


def _check_password(password: str) -> None:
    is_plain = password.isprintable() and password == password.strip() and password.isascii()
    if not LEAST_PASSWORD <= len(password) <= MOST_PASSWORD or not is_plain:
        raise WifiRefusedError(say("board.wifi.bad_password", least=LEAST_PASSWORD, most=MOST_PASSWORD))
