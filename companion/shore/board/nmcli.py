"""NetworkManager by its program nmcli: what it is asked, and its terse output (nmcli(1), 1.42).

In the terse table a field ends with a colon, and colons and backslashes inside it follow a backslash. Where
a record has a line for each field, nothing is escaped. Names of networks are read in hexadecimal, since they
may hold any byte, line ends included.
"""

import asyncio
import contextlib
import os
import re
from collections.abc import Sequence
from typing import Final, NamedTuple

from msgspec import Struct

from companion.core.errors import BoatError
from companion.shore.words import say

WIFI: Final = "802-11-wireless"
_PART: Final = re.compile(r"((?:[^:\\]|\\.)*)(?::|$)")
_ESCAPED: Final = re.compile(r"\\(.)")
_UUID: Final = re.compile(r"[0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12}")
_MOST_OUTPUT: Final = 400_000
_MOST_TEXT: Final = 300
_ENVIRONMENT: Final = {"LC_ALL": "C.UTF-8", "PATH": os.defpath, "TERM": "dumb"}


class NmcliError(BoatError):
    """NetworkManager refuses. Its one argument is the text for people."""


class Network(Struct, frozen=True):
    """A Wi-Fi in reach. signal: 0 to 100. security: open, WPA2, WPA3, or other, which cannot be joined."""

    name: str
    signal: int
    security: str
    is_used: bool


class Saved(Struct, frozen=True):
    """A connection that NetworkManager knows."""

    uuid: str
    name: str
    is_active: bool


class Link(NamedTuple):
    """A network interface. uuid: of its active connection, or empty."""

    device: str
    kind: str
    state: str
    uuid: str


class Nmcli:
    """The program. path: of nmcli."""

    def __init__(self, path: str = "nmcli") -> None:
        self._path = path

    async def ask(self, *arguments: str, said: str = "", longest_s: float = 20.0) -> str:
        """Its output. said: to its standard input, so that a password is in no list of processes.

        Raises:
            NmcliError: with its first line.
        """
        try:
            process = await asyncio.create_subprocess_exec(
                self._path,
                *arguments,
                stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE,
                env={**_ENVIRONMENT, "PATH": os.environ.get("PATH", os.defpath)},
                cwd="/",
            )
        except OSError as error:
            raise NmcliError(say("board.wifi.none", why=error.strerror or "")) from None
        try:
            async with asyncio.timeout(longest_s):
                out, err = await process.communicate(said.encode())
        except TimeoutError:
            raise NmcliError(say("board.wifi.late", n=longest_s)) from None
        finally:
            if process.returncode is None:
                with contextlib.suppress(ProcessLookupError):
                    process.kill()
                await process.wait()
        if process.returncode != 0:
            lines = err.decode("utf-8", "replace").splitlines() or [""]
            raise NmcliError(lines[0].removeprefix("Error: ")[:_MOST_TEXT] or say("board.wifi.refused"))
        return out[:_MOST_OUTPUT].decode("utf-8", "replace")

    async def rows(self, fields: Sequence[str], *arguments: str) -> list[list[str]]:
        """A terse table; lines that have another number of fields are left out."""
        out = await self.ask("-t", "-e", "yes", "-f", ",".join(fields), *arguments)
        return [row for line in out.split("\n") if len(row := split_row(line)) == len(fields)]

    async def networks(self) -> list[Network]:
        """The Wi-Fi networks in reach, the strongest first, each name once."""
        fields = ("IN-USE", "SSID-HEX", "SIGNAL", "SECURITY")
        found: dict[str, Network] = {}
        for used, name_hex, signal, security in await self.rows(fields, "device", "wifi", "list"):
            name = _name(name_hex)
            if not name or not signal.isdecimal():
                continue
            one = Network(name, min(int(signal[:4]), 100), _security(security), used.strip() == "*")
            other = found.get(name)
            if other is None or (one.is_used, one.signal) > (other.is_used, other.signal):
                found[name] = one
        return sorted(found.values(), key=lambda one: (not one.is_used, -one.signal, one.name))

    async def saved(self) -> list[Saved]:
        """The Wi-Fi connections that it knows."""
        rows = await self.rows(("UUID", "NAME", "TYPE", "ACTIVE"), "connection", "show")
        return [
            Saved(uuid, name, active == "yes")
            for uuid, name, kind, active in rows
            if kind == WIFI and _UUID.fullmatch(uuid)
        ]

    async def links(self) -> list[Link]:
        """The interfaces."""
        return [
            Link(*row) for row in await self.rows(("DEVICE", "TYPE", "STATE", "CON-UUID"), "device", "status")
        ]

    async def address(self, device: str) -> str:
        """The interface's IPv4 address, or empty."""
        out = await self.ask("-t", "-f", "IP4.ADDRESS", "device", "show", device)
        for line in out.splitlines():
            name, _, value = line.partition(":")
            if name.startswith("IP4.ADDRESS"):
                return value.partition("/")[0]
        return ""

    async def add(self, *settings: str, secret: str = "") -> str:
        """A new Wi-Fi connection; returns its UUID. secret: told to nmcli's editor over standard input."""
        out = await self.ask("connection", "add", "type", "wifi", *settings)
        found = _UUID.search(out[out.rfind("(") :])
        if found is None:
            raise NmcliError(say("board.wifi.refused"))
        uuid = found[0]
        if secret:
            lines = (f"set {WIFI}-security.psk {secret}", "save persistent", "quit", "")
            await self.ask("connection", "edit", "uuid", uuid, said="\n".join(lines))
        return uuid

    async def up(self, uuid: str, longest_s: float) -> None:
        """Activate a connection, and wait for its address."""
        wait = ("--wait", f"{longest_s:.0f}")
        await self.ask(*wait, "connection", "up", "uuid", uuid, longest_s=longest_s + 10.0)


def split_row(line: str) -> list[str]:
    """The fields of a line of the terse table."""
    fields, at = [], 0
    while (part := _PART.match(line, at)) is not None:
        fields.append(_ESCAPED.sub(r"\1", part[1]))
        if part.end() == part.end(1):  # no colon: the last field
            break
        at = part.end()
    return fields


def _name(name_hex: str) -> str:
    """A network's name; empty for one that is hidden or no printable text."""
    try:
        name = bytes.fromhex(name_hex).decode()
    except ValueError:
        return ""
    return name if name.isprintable() else ""


def _security(text: str) -> str:
    kinds = text.split()
    if not kinds or kinds == ["--"]:
        return "open"
    if "802.1X" in kinds or "OWE" in kinds or kinds == ["WEP"]:
        return "other"
    if "WPA2" in kinds or "WPA1" in kinds:
        return "WPA2"
    return "WPA3" if "WPA3" in kinds else "other"
