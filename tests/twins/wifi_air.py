"""The air round a boat, and a program `nmcli` in a folder that knows it (`fake_nmcli.py`)."""

import json
import sys
from pathlib import Path
from typing import Any

PROGRAM = Path(__file__).with_name("fake_nmcli.py")


class Air:
    """A folder: `bin/nmcli`, the networks, the connections."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        (folder / "bin").mkdir(parents=True)
        self.nmcli = folder / "bin" / "nmcli"
        self.nmcli.write_text(f'#!/bin/sh\nexec "{sys.executable}" -I "{PROGRAM}" "{folder}" "$@"\n', "utf-8")
        self.nmcli.chmod(0o755)
        self.networks: list[dict[str, Any]] = []
        self.write()

    def add(self, name: str, password: str = "", security: str = "", signal: int = 60, **more: Any) -> None:  # noqa: ANN401
        """A network in reach."""
        kind = security or ("WPA2" if password else "")
        self.networks.append({"name": name, "password": password, "security": kind, "signal": signal, **more})
        self.write()

    def write(self) -> None:
        """For the program."""
        (self.folder / "air.json").write_text(json.dumps(self.networks), encoding="utf-8")

    def know(self, name: str, *, is_active: bool = False, **more: Any) -> str:  # noqa: ANN401
        """A stored connection without a password; returns its UUID."""
        known = self.known()
        number = f"00000000-0000-0000-0000-{len(known):012d}"
        one = {"uuid": number, "name": name, "ssid": name, "mode": "infrastructure", "kind": "", "psk": ""}
        known.append(one | {"autoconnect": "yes", "active": is_active} | more)
        (self.folder / "known.json").write_text(json.dumps(known), encoding="utf-8")
        return number

    def known(self) -> list[dict[str, Any]]:
        """The connections now."""
        file = self.folder / "known.json"
        found: list[dict[str, Any]] = json.loads(file.read_text("utf-8")) if file.exists() else []
        return found

    def active(self) -> list[str]:
        """The networks in use."""
        return [one["ssid"] for one in self.known() if one["active"]]

    def calls(self) -> list[list[str]]:
        """The arguments of every call."""
        lines = (self.folder / "calls").read_text("utf-8").splitlines()
        return [json.loads(line) for line in lines]
