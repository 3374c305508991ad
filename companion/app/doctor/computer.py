"""Checks of the computer: model, supply, temperature, disk, clock and network."""

import os
from datetime import UTC, datetime
from ipaddress import IPv4Address, IPv4Network
from pathlib import Path

from companion.app.doctor.findings import Examined, Finding, Verdict, failed, fine, skipped, warning
from companion.config.boat_config import LinkConfig
from companion.links.port_url import parse_port_url

# Raspberry Pi documentation, vcgencmd get_throttled: these bits now, and 16 higher since the start
_THROTTLED = {0: "under-voltage", 1: "frequency capped", 2: "throttled", 3: "soft temperature limit"}
_UNDER_VOLTAGE = 1
_SINCE_START = 16
_SUPPLY = "measure 5.0 V at the Pi under load; use a 3 A converter and short, thick leads"
_HOT_C = 80.0  # the Pi begins to throttle (same source)
_UNSET_YEAR = 2025  # an older date was not set by anything


def check_model(examined: Examined) -> Finding:
    memory = (examined.read("/proc/meminfo") or "").split("kB")[0].split()
    size = f", {int(memory[-1]) / 1e6:.1f} GB" if memory and memory[-1].isdigit() else ""
    if not examined.model:
        return warning("computer", f"no Raspberry Pi{size}", "pins and buses may be missing")
    return fine("computer", f"{examined.model}{size}")


def check_supply(examined: Examined) -> Finding:
    """What the firmware says of voltage and throttling."""
    found = sorted(examined.path("/sys/devices/platform").glob("soc*/*firmware/get_throttled"))
    text = found[0].read_text(encoding="ascii").strip() if found else ""
    try:
        flags = int(text, 16)
    except ValueError:
        return skipped("supply", "the firmware does not report voltage and throttling")
    now = [name for bit, name in _THROTTLED.items() if flags >> bit & 1]
    before = [name for bit, name in _THROTTLED.items() if flags >> bit + _SINCE_START & 1]
    if now:
        verdict = Verdict.FAILED if flags & _UNDER_VOLTAGE else Verdict.WARNING
        return Finding("supply", verdict, f"now: {', '.join(now)}", _SUPPLY)
    if before:
        return warning("supply", f"since the start: {', '.join(before)}", _SUPPLY)
    return fine("supply", "no under-voltage and no throttling since the start")


def check_temperature(examined: Examined) -> Finding:
    text = examined.read("/sys/class/thermal/thermal_zone0/temp") or ""
    if not text.lstrip("-").isdigit():
        return skipped("temperature", "no thermometer")
    celsius = int(text) / 1000.0
    if celsius >= _HOT_C:
        return warning("temperature", f"{celsius:.0f} °C", "let air reach it, or shade the hull")
    return fine("temperature", f"{celsius:.0f} °C")


def check_disk(examined: Examined) -> Finding:
    """Room for missions and logs."""
    folder = examined.config.storage.folder
    if not folder:
        text = "missions, parameters and logs are not kept over a restart"
        return warning("disk", text, "set storage.folder")
    path = examined.path(str(Path(folder).expanduser().absolute()))
    place = next(one for one in (path, *path.parents) if one.exists())
    status = os.statvfs(place)
    free_mb = status.f_bavail * status.f_frsize / 1e6
    if status.f_flag & os.ST_RDONLY:
        return failed("disk", f"{folder} is read-only", "check the card")
    needed_mb = examined.config.log.min_free_mb
    if free_mb < needed_mb:
        text = f"{free_mb:.0f} MB free for {folder}; no log begins below {needed_mb:.0f} MB"
        return warning("disk", text, "delete files, or lower log.min_free_mb")
    return fine("disk", f"{free_mb / 1e3:.1f} GB free for {folder}")


def check_clock(examined: Examined, unix_s: float) -> Finding:
    """What sets the date."""
    date = datetime.fromtimestamp(unix_s, UTC)
    if examined.path("/run/systemd/timesync/synchronized").exists():
        return fine("clock", f"{date:%Y-%m-%d %H:%M} UTC, set by network")
    has_own = any(examined.path("/sys/class/rtc").glob("rtc*"))
    if date.year < _UNSET_YEAR:
        text = f"{date:%Y-%m-%d}, not set; the boat takes the date from its GNSS receiver"
        return warning("clock", text, "connect to a network once, or fit a clock with a battery")
    source = "kept by a clock with a battery" if has_own else "not confirmed by network; logs follow GNSS"
    return fine("clock", f"{date:%Y-%m-%d %H:%M} UTC, {source}")


def check_network(examined: Examined) -> Finding:
    up = [
        folder.name
        for folder in sorted(examined.path("/sys/class/net").glob("*"))
        if folder.name != "lo"
        and examined.read(f"/sys/class/net/{folder.name}/operstate") in ("up", "unknown")
    ]
    if up:
        return fine("network", f"up: {', '.join(up)}")
    if any(link.url.startswith("serial:") for link in examined.config.link_settings):
        return fine("network", "none; a link is on a serial line")
    return failed("network", "no interface is up", "join a Wi-Fi or start an access point")


def check_routes(examined: Examined) -> list[Finding]:
    """Whether the addresses that telemetry is sent to are in reach; a broadcast, in a network of our own."""
    routes = _routes(examined.read("/proc/net/route") or "")
    lost = []
    for link in examined.config.link_settings:
        url = parse_port_url(link.url)
        if url.kind not in ("udpout", "tcpout") or (address := _ipv4(url.place)) is None:
            continue
        reached = [network for network in routes if address in network]
        own = [network for network in reached if network.prefixlen > 0]
        if not reached or (str(address).endswith(".255") and not own):
            lost.append(link.url)
    if not lost:
        return []
    cure = "start the boat's access point, or use the broadcast address that `ip -4 address` shows after brd"
    return [warning("routes", f"no network of this computer has {', '.join(lost)}", cure)]


def check_open_links(examined: Examined) -> Finding:
    """Which links take commands from whoever reaches them."""
    links = [link.url for link in examined.config.link_settings if _is_open(link)]
    if not links:
        return fine("commands", "accepted from this computer, cables and signed links only")
    text = f"accepted from whoever reaches {', '.join(links)}, without the page's PIN"
    cure = (
        'keep the Wi-Fi\'s password to yourself, or set signing = "required" and a key_file (docs/signing.md)'
    )
    return warning("commands", text, cure)


def _is_open(link: LinkConfig) -> bool:
    """Neither signed, nor this computer's own, nor to one peer by a cable or a connection."""
    url = parse_port_url(link.url)
    if link.signing == "required" or url.kind == "tcpout":
        return False
    if url.kind == "serial":
        return link.radio is not False
    address = _ipv4(url.place)
    return url.place not in ("localhost", "::1") and (address is None or not address.is_loopback)


def _routes(table: str) -> list[IPv4Network]:
    networks = []
    for line in table.splitlines()[1:]:
        columns = line.split()
        if len(columns) > 7:
            place, mask = (IPv4Address(bytes.fromhex(columns[at])[::-1]) for at in (1, 7))
            networks.append(IPv4Network(f"{place}/{mask}", strict=False))
    return networks


def _ipv4(place: str) -> IPv4Address | None:
    try:
        return IPv4Address(place)
    except ValueError:
        return None


def computer_findings(examined: Examined, unix_s: float) -> list[Finding]:
    return [
        check_model(examined),
        check_supply(examined),
        check_temperature(examined),
        check_disk(examined),
        check_clock(examined, unix_s),
        check_network(examined),
        *check_routes(examined),
        check_open_links(examined),
    ]
