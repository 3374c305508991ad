"""Serial parts that talk NMEA 0183 into pseudo-terminals: a receiver and a compass as a boat has them."""

import contextlib
import math
import os
import pty
import threading
import tty
from collections.abc import Callable
from datetime import UTC, datetime
from functools import reduce
from operator import xor
from pathlib import Path
from typing import Self

PERIOD_S = 0.1


def sentence(body: str) -> bytes:
    """A sentence with its frame and checksum."""
    return f"${body}*{reduce(xor, body.encode('ascii')):02X}\r\n".encode("ascii")


def _degrees(value_deg: float, width: int, letters: str) -> str:
    whole, minutes = divmod(abs(value_deg) * 60.0, 60.0)
    return f"{int(whole):0{width}d}{minutes:08.5f},{letters[value_deg < 0.0]}"


def fix(lat_deg: float, lon_deg: float, now: datetime) -> bytes:
    """What a receiver says at each fix: RMC, then GGA, at rest."""
    time, date = f"{now:%H%M%S}.{now.microsecond // 10000:02d}", f"{now:%d%m%y}"
    place = f"{_degrees(lat_deg, 2, 'NS')},{_degrees(lon_deg, 3, 'EW')}"
    return sentence(f"GPRMC,{time},A,{place},0.0,0.0,{date},,,A") + sentence(
        f"GPGGA,{time},{place},1,12,0.9,30.0,M,47.0,M,,"
    )


def heading(heading_rad: float) -> bytes:
    """What a compass says."""
    return sentence(f"HEHDT,{math.degrees(heading_rad) % 360.0:.1f},T")


class TalkingPart:
    """A serial device that says something ten times a second until it is switched off."""

    def __init__(self, device: Path, say: Callable[[], bytes]) -> None:
        self._say = say
        self._is_off = threading.Event()
        self._far, near = pty.openpty()
        tty.setraw(near)
        os.set_blocking(self._far, False)
        device.symlink_to(os.ttyname(near))
        self._near = near
        self._thread = threading.Thread(target=self._run, name=device.name)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._is_off.set()
        self._thread.join(5.0)
        os.close(self._far)
        os.close(self._near)

    def _run(self) -> None:
        while not self._is_off.wait(PERIOD_S):
            with contextlib.suppress(OSError):  # nobody reads the line
                os.write(self._far, self._say())


def receiver(device: Path, lat_deg: float, lon_deg: float) -> TalkingPart:
    """A satellite receiver that lies still."""
    return TalkingPart(device, lambda: fix(lat_deg, lon_deg, datetime.now(UTC)))


def compass(device: Path, heading_rad: float) -> TalkingPart:
    """A compass that does not turn."""
    return TalkingPart(device, lambda: heading(heading_rad))
