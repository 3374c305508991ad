"""What a phone of six years ago waits for on a bad Wi-Fi: the shore page in a slowed Chromium.

    python -m benchmarks.shore_phone

Opens the page of an emulated boat three times with an empty cache, the processor six times slower and the
network slowed; prints the time to the first paint and to the first values, and the bytes.
"""

import re
import sys
from statistics import median
from typing import NamedTuple

from playwright.sync_api import Browser

from pictures.browser import open_browser, open_context
from pictures.shore import emulator

LOADS = 3
_SLOWER = 6
_LATENCY_MS = 300
_DOWN_BIT_S = 400_000
_UP_BIT_S = 200_000
_WAIT_MS = 60_000.0
_BATTERY = re.compile(r"Battery\D*\d")
_SEEN = """() => [
    performance.getEntriesByName("first-contentful-paint")[0].startTime,
    performance.now(),
    ["navigation", "resource"].flatMap((kind) => performance.getEntriesByType(kind))
        .reduce((sum, entry) => sum + entry.transferSize, 0),
]"""


class Load(NamedTuple):
    """Of one visitor. Times since the page was asked for."""

    painted_s: float
    values_s: float
    size_bytes: float


def load(browser: Browser, address: str) -> Load:
    """Open the page as a visitor who was never there, until the battery is shown."""
    context = open_context(browser, "phone")
    try:
        page = context.new_page()
        session = context.new_cdp_session(page)
        session.send("Network.enable")
        session.send("Network.setCacheDisabled", {"cacheDisabled": True})
        session.send("Emulation.setCPUThrottlingRate", {"rate": _SLOWER})
        network = {"offline": False, "latency": _LATENCY_MS}
        speed = {"downloadThroughput": _DOWN_BIT_S / 8, "uploadThroughput": _UP_BIT_S / 8}
        session.send("Network.emulateNetworkConditions", network | speed)
        page.goto(address, wait_until="commit", timeout=_WAIT_MS)
        page.locator("dl").filter(has_text=_BATTERY).wait_for(timeout=_WAIT_MS)
        painted_ms, values_ms, size_bytes = page.evaluate(_SEEN)
    finally:
        context.close()
    return Load(painted_ms / 1e3, values_ms / 1e3, size_bytes)


def main() -> None:
    """Print the medians."""
    with emulator() as boat, open_browser() as browser:
        loads = [load(browser, boat.page) for _ in range(LOADS)]
    painted_s, values_s, size_bytes = (median(column) for column in zip(*loads, strict=True))
    sys.stdout.write(
        f"{LOADS} loads, processor {_SLOWER} times slower, {_LATENCY_MS} ms, {_DOWN_BIT_S // 1000} kbit/s: "
        f"first paint {painted_s:.1f} s, first values {values_s:.1f} s, {size_bytes / 1000:.0f} kB\n"
    )


if __name__ == "__main__":
    main()
