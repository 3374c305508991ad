"""Does the bridge's memory stay flat over a million messages, whoever sends them?

In one process, over memory links: the first tenth fills caches and tables, what grows after that is a leak.
"""

import gc
import os
from pathlib import Path

from benchmarks.measure import Row, alone
from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import dialect
from companion.router.channels import Channels

_MESSAGES = 1_000_000
_AT_ONCE = 200
_SENDERS = 5_000  # more addresses than any table may hold


def rows() -> list[Row]:
    """Growth of the process over 900,000 messages between two links, with new senders too."""
    return [
        alone(f"memory growth over 900,000 messages, {count} sender(s)", "KiB", "less", [_growth_kib(count)])
        for count in (1, _SENDERS)
    ]


def _growth_kib(senders: int) -> float:
    near, far = memory_pair("from")
    out, drain = memory_pair("to")
    channels = Channels([MemoryPort(near, out)], Address(1, 1))
    channels.wanted = frozenset()
    channels.accept()
    addresses = [Address(2 + number % 250, 1 + number // 250) for number in range(senders)]
    encoders = [Encoder(address) for address in addresses]
    settled_kib, sent = 0.0, 0
    while sent < _MESSAGES:
        _send(far, encoders, sent)
        sent += _AT_ONCE
        now_s = sent / 20_000.0
        for _ in range(1 + _AT_ONCE // 64):
            for _received in channels.receive(now_s):
                pass
        drain.receive()
        if sent == _MESSAGES // 10:
            settled_kib = _resident_kib()
    return _resident_kib() - settled_kib


def _send(link: MemoryLink, encoders: list[Encoder], begin: int) -> None:
    for number in range(begin, begin + _AT_ONCE):
        message = dialect.MAVLink_attitude_message(number, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
        link.send(encoders[number % len(encoders)].encode(message))


def _resident_kib() -> float:
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1024.0
