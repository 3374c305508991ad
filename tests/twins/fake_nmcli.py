"""An nmcli with a NetworkManager of its own, in a folder: what 1.42 prints, for what the page asks.

    python fake_nmcli.py FOLDER …

`air.json` holds the networks in reach (name, hexadecimal if it is no text, signal, security, password),
`known.json` the connections; a file `broken` stops NetworkManager. Every call is noted in `calls`. Texts,
escaping and exit codes are those that nmcli printed beside a real NetworkManager without radio.
"""

import hashlib
import json
import re
import sys
import uuid
from pathlib import Path
from typing import Any

WIFI = "802-11-wireless"


def escaped(text: str) -> str:
    """As in the terse table."""
    return re.sub(r"([\\:])", r"\\\1", text)


def say(line: str) -> None:
    """To whoever called."""
    sys.stdout.write(f"{line}\n")


class Fake:
    """One call."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.air: list[dict[str, Any]] = json.loads((folder / "air.json").read_text("utf-8"))
        known = folder / "known.json"
        self.known: list[dict[str, Any]] = json.loads(known.read_text("utf-8")) if known.exists() else []

    def save(self) -> None:
        """The connections."""
        aside = self.folder / "known.new"
        aside.write_text(json.dumps(self.known), encoding="utf-8")
        aside.replace(self.folder / "known.json")

    def active(self) -> dict[str, Any] | None:
        """The connection in use."""
        return next((one for one in self.known if one["active"]), None)

    def table(self, fields: list[str], rows: list[dict[str, str]]) -> None:
        """As `-t -f` prints it."""
        for row in rows:
            say(":".join(escaped(row[field]) for field in fields))

    def run(self, words: list[str]) -> int:
        """Its exit code."""
        fields: list[str] = []
        while words and words[0].startswith("-"):
            if words[0] in ("-f", "-e", "--wait"):
                if words[0] == "-f":
                    fields = words[1].split(",")
                words = words[1:]
            words = words[1:]
        match words:
            case ["device", "status"]:
                now = self.active()
                wlan = {"DEVICE": "wlan0", "TYPE": "wifi", "STATE": "connected" if now else "disconnected"}
                self.table(
                    fields,
                    [
                        {"DEVICE": "lo", "TYPE": "loopback", "STATE": "unmanaged", "CON-UUID": ""},
                        wlan | {"CON-UUID": now["uuid"] if now else ""},
                    ],
                )
            case ["device", "wifi", "list"]:
                now = self.active()
                for one in self.air:
                    used = now is not None and one["name"] == now["ssid"]
                    row = {
                        "IN-USE": "*" if used else " ",
                        "SSID-HEX": one.get("hex") or one["name"].encode().hex().upper(),
                        "SIGNAL": str(one["signal"]),
                        "SECURITY": one["security"],
                    }
                    self.table(fields, [row])
            case ["device", "show", _]:
                now = self.active()
                if now is not None:
                    say(f"IP4.ADDRESS[1]:{'192.168.4.1' if now['mode'] == 'ap' else '10.0.0.7'}/24")
            case ["connection", "show"]:
                rows = [
                    {
                        "UUID": one["uuid"],
                        "NAME": one["name"],
                        "TYPE": WIFI,
                        "ACTIVE": "yes" if one["active"] else "no",
                    }
                    for one in self.known
                ]
                wired = {"UUID": str(uuid.uuid4()), "NAME": "eth0", "TYPE": "802-3-ethernet", "ACTIVE": "no"}
                self.table(fields, [*rows, wired])
            case ["connection", "add", "type", "wifi", *settings]:
                given = dict(zip(settings[::2], settings[1::2], strict=True))
                made = {
                    "uuid": str(uuid.uuid4()),
                    "name": given["con-name"],
                    "ssid": given["ssid"],
                    "mode": given.get(f"{WIFI}.mode", "infrastructure"),
                    "kind": given.get(f"{WIFI}-security.key-mgmt", ""),
                    "autoconnect": given.get("connection.autoconnect", "yes"),
                    "psk": "",
                    "active": False,
                }
                self.known.append(made)
                self.save()
                say(f"Connection '{made['name']}' ({made['uuid']}) successfully added.")
            case ["connection", "edit", "uuid", which]:
                return self.edit(which)
            case ["connection", verb, "uuid", which, *settings]:
                return self.change(verb, which, settings)
            case _:
                sys.stderr.write(
                    f"Error: argument '{words[:1]}' not understood. Try passing --help instead.\n"
                )
                return 2
        return 0

    def find(self, which: str) -> dict[str, Any] | None:
        """A connection."""
        return next((one for one in self.known if one["uuid"] == which), None)

    def edit(self, which: str) -> int:
        """The editor, over standard input."""
        one = self.find(which)
        assert one is not None
        for line in sys.stdin.read().splitlines():
            say(f"nmcli> {line}")
            if line.startswith(f"set {WIFI}-security.psk "):
                one["psk"] = line.removeprefix(f"set {WIFI}-security.psk ").strip()
        self.save()
        return 0

    def change(self, verb: str, which: str, settings: list[str]) -> int:
        """Up, down, modify, delete."""
        one = self.find(which)
        if one is None:
            sys.stderr.write(f"Error: unknown connection '{which}'.\n")
            return 10
        match verb:
            case "up":
                return self.up(one)
            case "down":
                if not one["active"]:
                    sys.stderr.write(f"Error: '{which}' is not an active connection.\n")
                    return 10
                one["active"] = False
            case "modify":
                one["autoconnect"] = settings[1]
            case "delete":
                self.known.remove(one)
        self.save()
        return 0

    def up(self, one: dict[str, Any]) -> int:
        """Activate: the right password of a network in reach, or the boat's own."""
        for other in self.known:
            other["active"] = False
        air = next((air for air in self.air if air["name"] == one["ssid"]), None)
        if one["mode"] == "ap":
            is_right = len(one["psk"]) == 64
        elif air is None:
            is_right = False
        else:
            password, name = air.get("password", ""), air["name"]
            key = hashlib.pbkdf2_hmac("sha1", password.encode(), name.encode(), 4096, 32).hex()
            is_right = one["psk"] == {"wpa-psk": key, "sae": password, "": ""}[one["kind"]]
        one["active"] = is_right
        self.save()
        if not is_right:
            sys.stderr.write(
                "Error: Connection activation failed: Secrets were required, but not provided.\n"
                "Hint: use 'journalctl -xe NM_CONNECTION=… + NM_DEVICE=wlan0' to get more details.\n"
            )
        return 0 if is_right else 4


def main() -> int:
    """Note the call and do it."""
    folder = Path(sys.argv[1])
    with (folder / "calls").open("a", encoding="utf-8") as calls:
        calls.write(json.dumps(sys.argv[2:]) + "\n")
    if (folder / "broken").exists():
        sys.stderr.write("Error: NetworkManager is not running.\n")
        return 8
    return Fake(folder).run(sys.argv[2:])


if __name__ == "__main__":
    sys.exit(main())
